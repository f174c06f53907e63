# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Which packages are missing, and how they get here. Expects report.sh, $root and $noetic (the
# prefix of ROS Noetic, empty where ROS comes from Debian).
: "${noetic?}"

# missing_packages FILE...: names for apt of what the lists ask for and this machine has not
missing_packages() {
  local name ros installed
  local -a wanted=()
  while read -r name ros _; do
    if [[ -z $name || $name == '#'* ]]; then
      continue
    elif [[ -n $noetic && $ros == ros:* ]]; then
      ros=${ros#ros:}
      [[ -e $noetic/share/$ros/package.xml ]] || wanted+=("ros-noetic-${ros//_/-}")
    else
      wanted+=("$name")
    fi
  done < <(cat -- "$@")
  # One call for all; dpkg-query complains about the names it has never heard of.
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null |
    awk '$2 == "installed" {print $1}') || true
  printf '%s\n' "${wanted[@]}" | sort -u | grep -vxF -e "$installed" || true
}

# as_root COMMAND...: directly or with sudo
as_root() {
  if ((EUID == 0)); then
    "$@"
  else
    sudo "$@"
  fi
}

may_become_root() { ((EUID == 0)) || command -v sudo >/dev/null; }

# install_packages FILE...: installs what is missing; returns 0 and sets $installed_something
installed_something=no
install_packages() {
  [[ -z ${RAVEN_SKIP_APT:-} ]] || return 0
  command -v dpkg-query >/dev/null ||
    refuse "this is not Debian or Ubuntu: install what $* list by your own means," \
      "then run again with RAVEN_SKIP_APT=1"
  local -a missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0

  local by_hand="apt-get install --no-install-recommends ${missing[*]}"
  may_become_root ||
    refuse "these packages are missing, and installing them needs root or sudo. As root: $by_hand"
  say "installing ${#missing[@]} missing packages: ${missing[*]}"
  local -a apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600
    -o Dpkg::Use-Pty=0)
  as_root "${apt[@]}" update >&2 || say "apt-get update failed; trying with the lists that are here"
  local name
  local -a unknown=()
  for name in "${missing[@]}"; do
    [[ $(apt-cache policy "$name" 2>/dev/null) == *'Candidate: '[^\(]* ]] || unknown+=("$name")
  done
  ((${#unknown[@]} == 0)) ||
    refuse "apt does not know ${unknown[*]}. This package is made for Debian 12 (bookworm), or for" \
      "ROS Noetic in /opt/ros/noetic; on another system install what the lists ask for by your own" \
      "means and run again with RAVEN_SKIP_APT=1"
  as_root "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2 ||
    fail "apt could not install what is missing (see above). By hand, as root: $by_hand"
  # shellcheck disable=SC2034  # read by build.sh
  installed_something=yes
}
