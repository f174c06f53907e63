// SPDX-License-Identifier: BSD-3-Clause
// Writes a session's bag from a thread of its own, so that no callback waits for the disk: bounded
// queue, parts by size and duration, *.bag.active until a part is complete, a clean end when the
// disk is nearly full. What is written, and when, is recorder.h.
#pragma once

#include <ros/message_traits.h>
#include <ros/time.h>
#include <rosbag/bag.h>

#include <boost/make_shared.hpp>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace raven_correction {

/// One message on its way to the bag; its type is hidden in `write`.
struct BagRecord {
  std::string topic;  ///< as it shall stand in the bag
  ros::Time time;     ///< of receipt; see SessionWriter::push()
  std::function<void(rosbag::Bag&, const BagRecord&)> write;
};

/// @param latched  `rosbag play` publishes it latched
template <typename Message>
BagRecord makeBagRecord(const std::string& topic, const ros::Time& time,
                        const boost::shared_ptr<const Message>& message, bool latched = false) {
  boost::shared_ptr<ros::M_string> header;
  if (latched) {
    header = boost::make_shared<ros::M_string>();
    (*header)["type"] = ros::message_traits::datatype(*message);
    (*header)["md5sum"] = ros::message_traits::md5sum(*message);
    (*header)["message_definition"] = ros::message_traits::definition(*message);
    (*header)["latching"] = "1";
  }
  return {topic, time, [message, header](rosbag::Bag& bag, const BagRecord& record) {
            bag.write(record.topic, record.time, message, header);
          }};
}

/// Bytes that may still be written to the file system of a directory.
/// @throws std::filesystem::filesystem_error  no such directory
std::uint64_t freeBytes(const std::string& directory);

struct SessionWriterOptions {
  std::uint64_t split_bytes = 0;     ///< a part is closed at this size [byte]; 0: never
  double split_duration = 0.0;       ///< a part is closed after this time of receipt [s]; 0: never
  std::uint64_t min_free_bytes = 0;  ///< the session ends in good order below this [byte]
  std::size_t queue_size = 100000;   ///< messages that wait for the disk; more are dropped [1]
  double check_period = 1.0;         ///< between two looks at the free space [s]
  std::function<std::uint64_t(const std::string&)> free_bytes = freeBytes;
};

/// One session, from its first part to its last. All members but the constructor and close() return
/// without waiting for the disk, and may be called from any thread.
class SessionWriter {
 public:
  enum class State { kWriting, kClosed, kDiskFull, kError };
  struct Progress {
    State state = State::kWriting;
    std::string message;             ///< the same in words, with the remedy where one is needed
    std::string bag;                 ///< part that is being written, or was written last
    std::vector<std::string> parts;  ///< complete parts, in order
    std::uint32_t part = 0;          ///< number of the current part, from 0
    std::uint64_t bytes = 0;         ///< written so far, all parts [byte]
    std::uint64_t free_bytes = 0;    ///< left on the disk when last looked at [byte]
    std::uint64_t written = 0;       ///< messages handed to the bag [1]
    std::uint64_t dropped = 0;       ///< messages lost: queue full, or the session had ended [1]
  };

  /// Creates directories as needed and opens the first part.
  /// @param path     absolute, with or without ".bag"; parts are NAME.bag, or NAME_0.bag,
  ///                 NAME_1.bag, ... where a split is set
  /// @param options  see there
  /// @throws InvalidInput  a file of that name exists, the disk is nearly full, or the file cannot
  ///         be written
  SessionWriter(const std::string& path, const SessionWriterOptions& options);
  ~SessionWriter();  ///< close()
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// Queues a message. A time before that of the message before it (the clock was set back), or
  /// before ros::TIME_MIN, is moved there: whoever reads a bag gets its messages by their times.
  /// @return false if it was dropped
  bool push(BagRecord record);
  /// The same, and it opens every later part again, until a newer one of its topic replaces it.
  bool pushSticky(BagRecord record);
  /// Writes what is queued, closes the last part and ends the thread. Further calls do nothing.
  Progress close();
  Progress progress() const;

 private:
  std::string partPath(std::uint32_t part) const;
  void run();
  void write(const BagRecord& record);
  void splitIfDue(const ros::Time& time);
  void checkDisk();
  void openPart();
  bool closePart();
  void stop(State state, const std::string& message);
  void fail(const std::string& what);

  const std::string stem_;  // path without ".bag"
  const SessionWriterOptions options_;

  // Of the writer thread, once it runs.
  std::unique_ptr<rosbag::Bag> bag_;
  std::string active_path_;
  ros::Time part_start_;
  std::uint64_t closed_bytes_ = 0;
  std::map<std::string, BagRecord> sticky_;
  ros::SteadyTime last_check_;

  struct Entry {
    BagRecord record;
    bool sticky = false;
  };
  bool enqueue(Entry entry);

  mutable std::mutex mutex_;  // of the members below
  std::condition_variable wake_;
  std::deque<Entry> queue_;
  ros::Time latest_ = ros::TIME_MIN;  // of the messages so far
  bool closing_ = false;
  Progress progress_;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace raven_correction
