// SPDX-License-Identifier: BSD-3-Clause
// What the ROS master knows: who else publishes on a topic, and whether it has forgotten this node,
// as a master that was started anew has.
#pragma once

#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>

#include <string>
#include <vector>

namespace raven_correction {

struct MasterView {
  bool answered = false;                      ///< else the rest is not known
  bool registered = false;                    ///< this node is a publisher of the topic
  std::vector<std::string> other_publishers;  ///< names of nodes
};

/// Asks the master; blocks until it answers or refuses: not for the live path.
/// @param topic  resolved name
MasterView askMaster(const std::string& topic);

/// What a node has told the master, to be told again. roscpp does so once only, at the start.
class Registrations {
 public:
  /// In a node that has been started: it has a node handle.
  Registrations();
  void add(const std::string& topic, const std::string& datatype, bool published) {
    topics_.push_back({topic, datatype, published});
  }
  void addService(const std::string& service) { services_.push_back(service); }
  /// Connections that exist go on in any case. @return true if the master took all of it
  bool repeat() const;

 private:
  struct Topic {
    std::string name, datatype;
    bool published;
  };
  std::string uri_, service_uri_;
  std::vector<Topic> topics_;
  std::vector<std::string> services_;
};

}  // namespace raven_correction
