// SPDX-License-Identifier: BSD-3-Clause
// Who else publishes on a topic, by the ROS master and in this process, and whether the master has
// forgotten this node, as one that was started anew has. Nothing here waits for longer than a
// limit.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>
#include <vector>

#include "raven_correction/dataset/topic_check.h"

namespace raven_correction {

/// Calls a method of the ROS master or of a node (their XML-RPC API), and waits no longer than
/// `timeout` for the answer: roscpp's own calls wait for ever when a machine hangs.
/// @param timeout  [s]; finding the host's address is not counted
/// @param payload  of the answer
/// @return false if there is no answer in time, or it is a refusal
bool callXmlRpc(const std::string& host, int port, const std::string& method,
                const XmlRpc::XmlRpcValue& arguments, double timeout, XmlRpc::XmlRpcValue& payload);

struct MasterView {
  bool answered = false;                      ///< else the rest is not known
  bool registered = false;                    ///< this node is a publisher of the topic
  std::vector<std::string> other_publishers;  ///< names of nodes
};

/// Asks the master; blocks until it answers, refuses, or 2 s have passed: not for the live path.
/// @param topic  resolved name
MasterView askMaster(const std::string& topic);

/// All topics that somebody publishes, with their types; blocks as askMaster() does.
/// @return false if the master does not answer
bool askTopics(std::vector<TopicType>& published);

/// How many publishers of a topic there are in this process: nodelets of one manager are one node
/// to the master. Of any thread.
/// @param topic  resolved name
std::size_t publishersInThisProcess(const std::string& topic);

/// What a node has told the master, to be told again. roscpp does so once only, at the start.
class Registrations {
 public:
  /// In a node that has been started: it has a node handle.
  Registrations();
  /// roscpp lists the topics of a process, not its services.
  /// @param service  resolved name
  void addService(const std::string& service) { services_.push_back(service); }
  /// All topics of this process (subscriptions without their types), the services that were added,
  /// and those of the loggers. Connections that exist go on in any case.
  /// @return true if the master took all of it; false at the first that it did not
  bool repeat() const;

 private:
  std::string uri_, service_uri_;
  std::vector<std::string> services_;
};

}  // namespace raven_correction
