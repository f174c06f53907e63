// SPDX-License-Identifier: BSD-3-Clause
// A master that hangs. One that is gone, or was started anew, is test/nodes/corrector_processes.py.
#include "raven_correction/ros/master_watch.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace raven_correction {
namespace {

/// Takes connections, since the system does, and never says a word.
class SilentServer {
 public:
  SilentServer() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(socket_, any, size), 0);
    EXPECT_EQ(::listen(socket_, 4), 0);
    EXPECT_EQ(::getsockname(socket_, any, &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~SilentServer() { ::close(socket_); }
  int port() const { return port_; }

 private:
  int socket_, port_ = 0;
};

TEST(CallXmlRpc, DoesNotWaitForAServerThatHangs) {
  const SilentServer server;
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = "/test";
  EXPECT_FALSE(callXmlRpc("127.0.0.1", server.port(), "getPid", arguments, 0.2, answer));
}

TEST(CallXmlRpc, FailsAtOnceWhereNobodyListens) {
  int port;
  {
    const SilentServer server;
    port = server.port();
  }
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = "/test";
  EXPECT_FALSE(callXmlRpc("127.0.0.1", port, "getPid", arguments, 60.0, answer));
}

TEST(CallXmlRpc, LeavesNoConnectionOpen) {
  const SilentServer server;
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = "/test";
  const int before = ::dup(0);
  ::close(before);
  for (int i = 0; i < 3; ++i)
    callXmlRpc("127.0.0.1", server.port(), "getPid", arguments, 0.01, answer);
  const int after = ::dup(0);
  ::close(after);
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace raven_correction
