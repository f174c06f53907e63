// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/private_launch.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <ros/ros.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kPoll = 0.05;         // between two looks at something outside [s]
constexpr double kPatience = 20.0;     // until what was asked to end is made to end [s]
constexpr std::size_t kLogLines = 15;  // of the log in an error
constexpr int kExecFailed = 127;       // exit code of a child that could not become roslaunch

volatile sig_atomic_t asked_to_end = 0;

void onSignal(int) {
  asked_to_end = 1;
  ros::requestShutdown();  // sets a flag: a service call that waits for its answer returns
}

void pause() { ros::WallDuration(kPoll).sleep(); }

/// A TCP port that nobody uses; it may be taken again before the master has it, which is then said
/// by roslaunch.
int freePort() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const bool bound = probe >= 0 && bind(probe, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  const int error = errno;
  if (probe >= 0) close(probe);
  if (!bound)
    throw std::runtime_error(format("no free port for a ROS master: %s", std::strerror(error)));
  return ntohs(address.sin_port);
}

/// Processes of the session, by /proc/PID/stat: after the name in parentheses come state, parent,
/// group and session.
std::vector<pid_t> membersOf(pid_t session) {
  std::vector<pid_t> members;
  std::error_code ignored;
  for (fs::directory_iterator entry("/proc", ignored), end; entry != end;
       entry.increment(ignored)) {
    const std::string name = entry->path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream file(entry->path() / "stat");
    std::string line;
    std::getline(file, line);
    const std::size_t after = line.rfind(')');
    if (after == std::string::npos) continue;
    std::istringstream fields(line.substr(after + 1));
    std::string state;
    long parent = 0, group = 0, of = 0;
    fields >> state >> parent >> group >> of;
    if (of == session && state != "Z") members.push_back(static_cast<pid_t>(std::stol(name)));
  }
  return members;
}

std::string lastLines(const std::string& file) {
  std::ifstream in(file);
  std::deque<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
    if (lines.size() > kLogLines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

}  // namespace

PrivateLaunch::PrivateLaunch(const std::vector<std::string>& arguments, const std::string& folder,
                             const std::string& node, double timeout) {
  const std::string home = fs::absolute(folder) / "ros";
  setenv("ROS_MASTER_URI", format("http://localhost:%d", freePort()).c_str(), 1);
  setenv("ROS_HOSTNAME", "localhost", 1);
  setenv("ROS_HOME", home.c_str(), 1);
  setenv("ROS_LOG_DIR", (home + "/log").c_str(), 1);
  unsetenv("ROS_IP");
  unsetenv("ROS_NAMESPACE");
  fs::create_directories(home);
  ros::init(ros::M_string(), node,
            ros::init_options::NoSigintHandler | ros::init_options::AnonymousName);
  asked_to_end = 0;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) signal(number, onSignal);
  try {
    start(arguments, folder);
    const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(timeout);
    // The parameters are there before the first node is.
    while (!ros::master::check() || !ros::param::has("/use_sim_time")) {
      requireAlive();
      if (ros::SteadyTime::now() > deadline)
        throw std::runtime_error(format("the ROS master does not answer after %.0f s; its log:%s",
                                        timeout, lastLines(log_).c_str()));
      pause();
    }
  } catch (...) {
    end();
    throw;
  }
}

void PrivateLaunch::start(const std::vector<std::string>& arguments, const std::string& folder) {
  log_ = fs::absolute(folder) / "nodes.log";
  std::vector<std::string> words{"roslaunch"};  // starts the master that ROS_MASTER_URI names
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int log = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0)
    throw InvalidInput(format("%s: cannot be written: %s", log_.c_str(), std::strerror(errno)));
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    setsid();                         // Ctrl-C of the terminal is for this process alone
    prctl(PR_SET_PDEATHSIG, SIGINT);  // even if it is killed, the nodes end
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    if (getppid() == parent) execvp(argv[0], argv.data());
    _exit(kExecFailed);
  }
  const int error = errno;
  close(log);
  if (pid_ < 0)
    throw std::runtime_error(format("roslaunch cannot be started: %s", std::strerror(error)));
}

void PrivateLaunch::requireAlive() {
  if (asked_to_end != 0) throw std::runtime_error("interrupted");
  int status = 0;
  if (pid_ <= 0 || waitpid(pid_, &status, WNOHANG) == 0) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kExecFailed)
    throw std::runtime_error("roslaunch is not in PATH; use ./run offline, or source setup.bash");
  throw std::runtime_error("the nodes have ended; the end of " + log_ + ":" + lastLines(log_));
}

void PrivateLaunch::waitForServices(const std::vector<std::string>& names, double timeout) {
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(timeout);
  for (const std::string& name : names)
    while (!ros::service::exists(name, false)) {
      requireAlive();
      if (ros::SteadyTime::now() > deadline)
        throw std::runtime_error(format("no service %s after %.0f s; the end of %s:%s",
                                        name.c_str(), timeout, log_.c_str(),
                                        lastLines(log_).c_str()));
      pause();
    }
}

void PrivateLaunch::end() noexcept {
  if (pid_ <= 0) return;
  kill(pid_, SIGINT);
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kPatience);
  for (;;) {
    waitpid(pid_, nullptr, WNOHANG);
    const std::vector<pid_t> members = membersOf(pid_);
    if (members.empty()) break;
    if (ros::SteadyTime::now() > deadline)
      for (const pid_t member : members) kill(member, SIGKILL);
    pause();
  }
  pid_ = -1;
}

PrivateLaunch::~PrivateLaunch() {
  if (ros::isStarted()) ros::shutdown();
  end();
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) signal(number, SIG_DFL);
}

}  // namespace raven_correction
