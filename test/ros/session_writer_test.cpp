// SPDX-License-Identifier: BSD-3-Clause
// Is every message in the bag, whatever happens: parts, a full disk, a disk that fails, a queue
// that overflows, a recorder that is killed?
#include "raven_correction/ros/session_writer.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <future>

#include "raven_correction/error.h"
#include "support/temporary_directory.h"
#include "support/wait_for.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;
using State = SessionWriter::State;

BagRecord text(const std::string& topic, double time, const std::string& data) {
  const auto message = boost::make_shared<std_msgs::String>();
  message->data = data;
  return makeBagRecord<std_msgs::String>(topic, ros::Time(time), message);
}

BagRecord counted(int i) { return text("numbers", 100.0 + 0.001 * i, std::to_string(i)); }

std::vector<std::string> contents(const std::string& path, const std::string& topic) {
  rosbag::Bag bag(path, rosbag::bagmode::Read);
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  std::vector<std::string> all;
  for (const rosbag::MessageInstance& message : view)
    all.push_back(message.instantiate<std_msgs::String>()->data);
  return all;
}

TEST(SessionWriter, WritesEveryMessageInOrder) {
  const TemporaryDirectory directory;
  SessionWriter writer(directory.path() + "/new/session.bag", {});
  EXPECT_TRUE(fs::exists(directory.path() + "/new/session.bag.active"));
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(writer.push(counted(i)));
  const SessionWriter::Progress end = writer.close();
  EXPECT_EQ(end.state, State::kClosed);
  EXPECT_EQ(end.written, 5000u);
  EXPECT_EQ(end.dropped, 0u);
  ASSERT_EQ(end.parts, std::vector<std::string>{directory.path() + "/new/session.bag"});
  EXPECT_FALSE(fs::exists(end.parts[0] + ".active"));
  EXPECT_EQ(end.bytes, fs::file_size(end.parts[0]));
  const auto all = contents(end.parts[0], "numbers");
  ASSERT_EQ(all.size(), 5000u);
  for (int i = 0; i < 5000; ++i) EXPECT_EQ(all[static_cast<std::size_t>(i)], std::to_string(i));
}

TEST(SessionWriter, KeepsTheOrderOfArrivalWhenTheClockIsSetBack) {
  const TemporaryDirectory directory;
  SessionWriter writer(directory.path() + "/session", {});
  for (const double time : {0.0, 100.0, 90.0, 95.0, 101.0})
    writer.push(text("numbers", time, std::to_string(time)));
  const auto all = contents(writer.close().parts.at(0), "numbers");
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all[2], std::to_string(90.0));
  EXPECT_EQ(all[3], std::to_string(95.0));
}

TEST(SessionWriter, OverwritesNothing) {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/session";
  SessionWriter(path, {}).close();
  EXPECT_THROW(SessionWriter(path + ".bag", {}), InvalidInput);
  fs::rename(path + ".bag", path + ".bag.active");
  EXPECT_THROW(SessionWriter(path, {}), InvalidInput);
  EXPECT_THROW(SessionWriter("/proc/nowhere/session", {}), InvalidInput);
}

TEST(SessionWriter, SplitsByDurationAndOpensEveryPartWithTheStickyMessages) {
  const TemporaryDirectory directory;
  SessionWriterOptions options;
  options.split_duration = 1.0;
  SessionWriter writer(directory.path() + "/session", options);
  writer.pushSticky(text("sticky", 100.0, "old"));
  writer.pushSticky(text("sticky", 100.0, "new"));
  for (int i = 0; i < 3500; ++i) writer.push(counted(i));
  const SessionWriter::Progress end = writer.close();
  ASSERT_EQ(end.parts.size(), 4u);
  EXPECT_EQ(end.parts[3], directory.path() + "/session_3.bag");
  std::size_t total = 0;
  for (std::size_t part = 0; part < 4; ++part) {
    const auto sticky = contents(end.parts[part], "sticky");
    EXPECT_EQ(sticky, part == 0 ? (std::vector<std::string>{"old", "new"})
                                : std::vector<std::string>{"new"});
    const auto numbers = contents(end.parts[part], "numbers");
    ASSERT_FALSE(numbers.empty());
    EXPECT_EQ(numbers.front(), std::to_string(total));  // nothing lost between the parts
    total += numbers.size();
  }
  EXPECT_EQ(total, 3500u);
}

TEST(SessionWriter, SplitsBySize) {
  const TemporaryDirectory directory;
  SessionWriterOptions options;
  options.split_bytes = 1000000;
  SessionWriter writer(directory.path() + "/session", options);
  for (int i = 0; i < 40; ++i) writer.push(text("large", 1.0 + i, std::string(100000, 'x')));
  const SessionWriter::Progress end = writer.close();
  ASSERT_GE(end.parts.size(), 4u);
  for (const std::string& part : end.parts)  // one message more than the limit, and the index
    EXPECT_LT(fs::file_size(part), 1000000u + 100000u + 20000u);
}

TEST(SessionWriter, EndsInGoodOrderWhenTheDiskIsNearlyFull) {
  const TemporaryDirectory directory;
  std::atomic<std::uint64_t> free{5000000};
  SessionWriterOptions options;
  options.min_free_bytes = 1000000;
  options.check_period = 0.01;
  options.free_bytes = [&](const std::string&) { return free.load(); };
  SessionWriter writer(directory.path() + "/session", options);
  writer.push(counted(0));
  ASSERT_TRUE(waitFor([&] { return writer.progress().written == 1; }, 5.0));
  free = 999999;
  ASSERT_TRUE(waitFor([&] { return writer.progress().state == State::kDiskFull; }, 5.0));
  EXPECT_FALSE(writer.push(counted(1)));
  const SessionWriter::Progress end = writer.close();
  EXPECT_EQ(end.state, State::kDiskFull);
  EXPECT_NE(end.message.find("min_free_mb"), std::string::npos) << end.message;
  EXPECT_EQ(end.dropped, 1u);
  ASSERT_EQ(end.parts.size(), 1u);
  EXPECT_EQ(contents(end.parts[0], "numbers"), std::vector<std::string>{"0"});
  EXPECT_THROW(SessionWriter(directory.path() + "/next", options), InvalidInput);
}

TEST(SessionWriter, SurvivesADiskThatFailsAndKeepsWhatItHas) {
  // A limit on the size of files makes write() fail like a full disk does. In a child process,
  // because the limit is of the process.
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/session";
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{2000000, 2000000};
    setrlimit(RLIMIT_FSIZE, &limit);
    SessionWriter writer(path, {});
    for (int i = 0; i < 40; ++i) writer.push(text("large", 1.0 + i, std::string(100000, 'x')));
    const SessionWriter::Progress end = writer.close();
    const bool explained = end.message.find("rosbag reindex") != std::string::npos;
    _exit(end.state == State::kError && explained && end.dropped > 0 ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(fs::exists(path + ".bag.active"));
}

TEST(SessionWriter, CountsWhatDoesNotFitTheQueueAndNeverBlocks) {
  const TemporaryDirectory directory;
  SessionWriterOptions options;
  options.queue_size = 10;
  SessionWriter writer(directory.path() + "/session", options);
  std::promise<void> disk_moves, disk_stands;
  BagRecord slow = counted(0);
  slow.write = [&](rosbag::Bag&, const BagRecord&) {
    disk_stands.set_value();
    disk_moves.get_future().wait();
  };
  writer.push(slow);
  disk_stands.get_future().wait();
  int taken = 0;
  for (int i = 0; i < 25; ++i) taken += writer.push(counted(i));
  EXPECT_EQ(taken, 10);
  disk_moves.set_value();
  const SessionWriter::Progress end = writer.close();
  EXPECT_EQ(end.written, 11u);
  EXPECT_EQ(end.dropped, 15u);
}

TEST(SessionWriter, LeavesABagThatReindexMakesReadableWhenKilled) {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/session";
  const pid_t child = fork();
  if (child == 0) {
    SessionWriter writer(path, {});
    for (int i = 0; i < 30; ++i) writer.push(text("large", 1.0 + i, std::string(100000, 'x')));
    waitFor([&] { return writer.progress().written == 30; }, 10.0);
    std::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  const std::string killed = path + ".bag.active";
  ASSERT_TRUE(fs::exists(killed));
  ASSERT_EQ(
      std::system(("PATH=/usr/bin:$PATH rosbag reindex -q -f " + killed + " > /dev/null").c_str()),
      0);
  const auto recovered = contents(killed, "large");
  // Of 3 MB at most the last chunk is lost: 768 KB, and the message that did not fit it.
  EXPECT_GE(recovered.size(), 30u - 9u);
  for (const std::string& data : recovered) EXPECT_EQ(data.size(), 100000u);
}

}  // namespace
}  // namespace raven_correction
