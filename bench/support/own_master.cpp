// SPDX-License-Identifier: BSD-3-Clause
#include "bench/support/own_master.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "raven_correction/error.h"

namespace raven_correction {
namespace bench {
namespace {

namespace fs = std::filesystem;

int freePort() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (probe < 0 || bind(probe, any, size) != 0 || getsockname(probe, any, &size) != 0)
    throw std::runtime_error("no free port");
  close(probe);
  return ntohs(address.sin_port);
}

std::string lastLines(const fs::path& file) {
  std::ifstream stream(file);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (text.size() > 2000) text.erase(0, text.size() - 2000);
  return text;
}

}  // namespace

OwnMaster::OwnMaster(const std::string& node_name)
    : folder_(fs::temp_directory_path() / ("raven_bench_" + std::to_string(getpid()))) {
  fs::create_directories(folder_ / "log");
  const int port = freePort();
  setenv("ROS_MASTER_URI", format("http://127.0.0.1:%d", port).c_str(), 1);
  setenv("ROS_IP", "127.0.0.1", 1);
  unsetenv("ROS_HOSTNAME");
  setenv("ROS_LOG_DIR", (folder_ / "log").c_str(), 1);
  start("rosmaster", {"rosmaster", "--core", "-p", std::to_string(port)});
  int no_arguments = 0;
  ros::init(no_arguments, nullptr, node_name, ros::init_options::NoSigintHandler);
  waitUntil([] { return ros::master::check(); }, "the master");
}

OwnMaster::~OwnMaster() {
  ros::shutdown();
  for (const auto& [name, process] : children_) kill(process, SIGTERM);
  for (const auto& [name, process] : children_) waitpid(process, nullptr, 0);
  std::error_code ignored;
  if (!keep_) fs::remove_all(folder_, ignored);
}

pid_t OwnMaster::start(const std::string& name, const std::vector<std::string>& command) {
  const std::string log = (folder_ / (name + ".log")).string();
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("cannot start " + command.front());
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  children_[name] = process;
  return process;
}

pid_t OwnMaster::startNode(const std::string& node, const std::string& ns) {
  const char* const build = std::getenv("RAVEN_BUILD");  // ./run sets it
  if (build == nullptr) throw std::runtime_error("RAVEN_BUILD is not set; start it with ./run");
  return start(ns + "_" + node, {std::string(build) + "/devel/lib/raven_correction/" + node,
                                 "__ns:=/" + ns, "__name:=" + node});
}

void OwnMaster::checkAlive() {
  for (auto child = children_.begin(); child != children_.end(); ++child) {
    if (waitpid(child->second, nullptr, WNOHANG) == 0) continue;
    const std::string name = child->first;
    children_.erase(child);
    throw std::runtime_error(name + " has ended: " + lastLines(folder_ / (name + ".log")));
  }
}

int realtimePriority(pid_t process) {
  std::vector<int> priorities{0, 0};
  std::error_code gone;
  for (const auto& task :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", gone)) {
    const pid_t thread = std::stoi(task.path().filename().string());
    sched_param parameters{};  // zero priority wherever the policy is not real-time
    if (sched_getparam(thread, &parameters) == 0) priorities.push_back(parameters.sched_priority);
  }
  std::sort(priorities.rbegin(), priorities.rend());
  return priorities[1];
}

double processorTime(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string line, field;
  std::getline(file, line);
  // After the name in parentheses: state, 10 others, then user and system time in ticks.
  std::istringstream fields(line.substr(line.rfind(')') + 2));
  double ticks = 0.0;
  for (int i = 0; i < 13 && fields >> field; ++i)
    if (i >= 11) ticks += std::stod(field);
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace bench
}  // namespace raven_correction
