// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/master_watch.h"

#include <ros/connection_manager.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/publication.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <chrono>

namespace raven_correction {
namespace {

constexpr double kTimeout = 2.0;  // of one call [s]

bool ask(const std::string& method, const XmlRpc::XmlRpcValue& arguments,
         XmlRpc::XmlRpcValue& answer) {
  return callXmlRpc(ros::master::getHost(), static_cast<int>(ros::master::getPort()), method,
                    arguments, kTimeout, answer);
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
  callXmlRpc(host, static_cast<int>(port), "publisherUpdate", arguments, kTimeout, answer);
}

}  // namespace

bool callXmlRpc(const std::string& host, int port, const std::string& method,
                const XmlRpc::XmlRpcValue& arguments, double timeout,
                XmlRpc::XmlRpcValue& payload) {
  using Clock = std::chrono::steady_clock;
  constexpr double kPatience = 0.05;  // of one round [s]
  XmlRpc::XmlRpcClient client(host.c_str(), port, "/");
  XmlRpc::XmlRpcValue response;
  if (!client.executeNonBlock(method.c_str(), arguments)) return false;
  const auto end = Clock::now() + std::chrono::duration<double>(timeout);
  while (!client.executeCheckDone(response)) {
    // The client takes itself out of its dispatcher where the connection fails.
    if (client._disp._sources.empty() || Clock::now() > end) return false;
    client._disp.work(kPatience);
  }
  // [code, text, payload], and code 1 is success
  if (client.isFault() || response.getType() != XmlRpc::XmlRpcValue::TypeArray ||
      response.size() != 3 || response[0].getType() != XmlRpc::XmlRpcValue::TypeInt ||
      static_cast<int>(response[0]) != 1)
    return false;
  payload = response[2];
  return true;
}

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

bool askTopics(std::vector<TopicType>& published) {
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = ros::this_node::getName();
  arguments[1] = "";
  if (!ask("getPublishedTopics", arguments, answer)) return false;
  published.clear();
  try {  // [[topic, type], ...]
    for (int i = 0; i < answer.size(); ++i)
      published.push_back(
          {static_cast<std::string>(answer[i][0]), static_cast<std::string>(answer[i][1])});
  } catch (const XmlRpc::XmlRpcException&) {  // no master answers like that
    return false;
  }
  return true;
}

std::size_t publishersInThisProcess(const std::string& topic) {
  const ros::PublicationPtr publication = ros::TopicManager::instance()->lookupPublication(topic);
  return publication ? publication->getNumCallbacks() : 0;
}

// Asked for at the start: a node that is being shut down has no port any more.
Registrations::Registrations()
    : uri_(ros::XMLRPCManager::instance()->getServerURI()),
      service_uri_("rosrpc://" + ros::network::getHost() + ":" +
                   std::to_string(ros::ConnectionManager::instance()->getTCPPort())),
      services_{ros::this_node::getName() + "/get_loggers",
                ros::this_node::getName() + "/set_logger_level"} {}

bool Registrations::repeat() const {
  XmlRpc::XmlRpcValue arguments, answer;
  arguments[0] = ros::this_node::getName();
  // A node that is being shut down has taken itself off the master's list.
  const auto told = [&](const char* method) { return ros::ok() && ask(method, arguments, answer); };
  std::vector<std::string> published, subscribed;
  ros::this_node::getAdvertisedTopics(published);
  ros::this_node::getSubscribedTopics(subscribed);
  arguments[3] = uri_;
  for (const std::string& topic : published) {
    const ros::PublicationPtr publication = ros::TopicManager::instance()->lookupPublication(topic);
    if (!publication) continue;  // not any more
    arguments[1] = topic;
    arguments[2] = publication->getDataType();
    if (!told("registerPublisher")) return false;
  }
  for (const std::string& topic : subscribed) {
    arguments[1] = topic;
    arguments[2] = "*";
    if (!told("registerSubscriber")) return false;
    // An empty list would end connections to publishers that the master does not know yet.
    if (answer.getType() == XmlRpc::XmlRpcValue::TypeArray && answer.size() > 0)
      tellOurselves(uri_, topic, answer);
  }
  arguments[2] = service_uri_;
  for (const std::string& service : services_) {
    arguments[1] = service;
    if (!told("registerService")) return false;
  }
  return true;
}

}  // namespace raven_correction
