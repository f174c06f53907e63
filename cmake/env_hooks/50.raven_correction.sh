# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=sh
# Sourced by setup.sh. Where ROS comes from Debian it lives in /usr/share, which is not a catkin
# workspace, so catkin leaves it out of ROS_PACKAGE_PATH. Debian's rospack and roslaunch look there all
# the same; tools that read the variable themselves do not.
if [ -e /usr/share/roscpp/package.xml ]; then
  case ":${ROS_PACKAGE_PATH:-}:" in
    *:/usr/share:*) ;;
    *) export ROS_PACKAGE_PATH="${ROS_PACKAGE_PATH:+$ROS_PACKAGE_PATH:}/usr/share" ;;
  esac
fi
