// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/master_watch.h"

#include <ros/connection_manager.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

namespace raven_correction {
namespace {

bool ask(const std::string& method, XmlRpc::XmlRpcValue& arguments, XmlRpc::XmlRpcValue& answer) {
  XmlRpc::XmlRpcValue response;
  return ros::master::execute(method, arguments, response, answer, /*wait_for_master=*/false);
}

/// As the master does when a publisher appears; roscpp lets nobody else set them.
void tellOurselves(const std::string& uri, const std::string& topic,
                   XmlRpc::XmlRpcValue& publishers) {
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return;
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = "/master";
  arguments[1] = topic;
  arguments[2] = publishers;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  client.execute("publisherUpdate", arguments, answer);
}

}  // namespace

MasterView askMaster(const std::string& topic) {
  MasterView view;
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = ros::this_node::getName();
  if (!ask("getSystemState", arguments, answer)) return view;
  view.answered = true;
  // [publishers, subscribers, services], the first a list of [topic, [node, ...]]
  try {
    XmlRpc::XmlRpcValue& published = answer[0];
    for (int i = 0; i < published.size(); ++i) {
      if (static_cast<std::string>(published[i][0]) != topic) continue;
      XmlRpc::XmlRpcValue& nodes = published[i][1];
      for (int k = 0; k < nodes.size(); ++k) {
        const std::string node = static_cast<std::string>(nodes[k]);
        if (node == ros::this_node::getName())
          view.registered = true;
        else
          view.other_publishers.push_back(node);
      }
    }
  } catch (const XmlRpc::XmlRpcException&) {  // no master answers like that
    view.answered = false;
  }
  return view;
}

// Asked for at the start: a node that is being shut down has no port any more.
Registrations::Registrations()
    : uri_(ros::XMLRPCManager::instance()->getServerURI()),
      service_uri_("rosrpc://" + ros::network::getHost() + ":" +
                   std::to_string(ros::ConnectionManager::instance()->getTCPPort())) {}

bool Registrations::repeat() const {
  bool complete = true;
  for (const Topic& topic : topics_) {
    XmlRpc::XmlRpcValue arguments, answer;
    arguments[0] = ros::this_node::getName();
    arguments[1] = topic.name;
    arguments[2] = topic.datatype;
    arguments[3] = uri_;
    if (!ros::ok()) return false;  // it has taken itself off the master's list
    if (!ask(topic.published ? "registerPublisher" : "registerSubscriber", arguments, answer)) {
      complete = false;
      continue;
    }
    if (topic.published) continue;
    // An empty list would end connections to publishers that the master does not know yet.
    if (answer.getType() == XmlRpc::XmlRpcValue::TypeArray && answer.size() > 0)
      tellOurselves(uri_, topic.name, answer);
  }
  for (const std::string& service : services_) {
    XmlRpc::XmlRpcValue arguments, answer;
    arguments[0] = ros::this_node::getName();
    arguments[1] = service;
    arguments[2] = service_uri_;
    arguments[3] = uri_;
    if (!ros::ok()) return false;
    complete = ask("registerService", arguments, answer) && complete;
  }
  return complete;
}

}  // namespace raven_correction
