// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/ros/session_writer.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6;  // [byte]

std::string withoutExtension(const std::string& path) {
  const std::string extension = ".bag";
  const bool has = path.size() > extension.size() &&
                   path.compare(path.size() - extension.size(), extension.size(), extension) == 0;
  return has ? path.substr(0, path.size() - extension.size()) : path;
}

}  // namespace

std::uint64_t freeBytes(const std::string& directory) { return fs::space(directory).available; }

SessionWriter::SessionWriter(const std::string& path, const SessionWriterOptions& options)
    : stem_(withoutExtension(path)), options_(options) {
  const std::string directory = fs::path(stem_).parent_path().string();
  std::error_code error;
  fs::create_directories(directory, error);
  if (error)
    throw InvalidInput(format("cannot create %s: %s; set ~directory to a place where you may write",
                              directory.c_str(), error.message().c_str()));
  progress_.free_bytes = options_.free_bytes(directory);
  if (progress_.free_bytes < options_.min_free_bytes)
    throw InvalidInput(
        format("%.0f MB free in %s, less than min_free_mb = %.0f; delete old bags or "
               "set ~directory to another disk",
               static_cast<double>(progress_.free_bytes) / kMegabyte, directory.c_str(),
               static_cast<double>(options_.min_free_bytes) / kMegabyte));
  openPart();
  last_check_ = ros::SteadyTime::now();
  thread_ = std::thread(&SessionWriter::run, this);
}

SessionWriter::~SessionWriter() { close(); }

std::string SessionWriter::partPath(std::uint32_t part) const {
  const bool split = options_.split_bytes > 0 || options_.split_duration > 0.0;
  return split ? format("%s_%u.bag", stem_.c_str(), part) : stem_ + ".bag";
}

bool SessionWriter::push(BagRecord record) { return enqueue({std::move(record), false}); }

bool SessionWriter::pushSticky(BagRecord record) { return enqueue({std::move(record), true}); }

bool SessionWriter::enqueue(Entry entry) {
  const std::lock_guard<std::mutex> lock(mutex_);
  latest_ = entry.record.time = std::max(entry.record.time, latest_);
  const bool full = queue_.size() >= options_.queue_size;
  if (closing_ || full || progress_.state != State::kWriting) {
    ++progress_.dropped;
    return false;
  }
  queue_.push_back(std::move(entry));
  wake_.notify_one();
  return true;
}

SessionWriter::Progress SessionWriter::close() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closing_ = true;
    wake_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
  return progress();
}

SessionWriter::Progress SessionWriter::progress() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return progress_;
}

void SessionWriter::run() {
  std::deque<Entry> batch;
  bool closing = false;
  while (!closing) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait_for(lock, std::chrono::duration<double>(options_.check_period),
                     [&] { return closing_ || !queue_.empty(); });
      batch.clear();
      batch.swap(queue_);
      closing = closing_;
    }
    std::uint64_t done = 0;
    for (const Entry& entry : batch) {
      if (!bag_) break;  // the session has ended
      splitIfDue(entry.record.time);
      if (bag_) write(entry.record);
      if (bag_) ++done;
      if (entry.sticky) sticky_[entry.record.topic] = entry.record;
      checkDisk();
    }
    checkDisk();
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_.written += done;
    progress_.dropped += batch.size() - done;
    if (bag_) progress_.bytes = closed_bytes_ + bag_->getSize();
  }
  if (bag_ && closePart()) stop(State::kClosed, "the bag is closed and complete");
}

void SessionWriter::write(const BagRecord& record) {
  if (part_start_.isZero()) part_start_ = record.time;
  try {
    record.write(*bag_, record);
  } catch (const std::exception& e) {
    fail(e.what());
  }
}

void SessionWriter::splitIfDue(const ros::Time& time) {
  const bool too_large = options_.split_bytes > 0 && bag_->getSize() >= options_.split_bytes;
  const bool too_long = options_.split_duration > 0.0 && !part_start_.isZero() &&
                        (time - part_start_).toSec() >= options_.split_duration;
  if (!too_large && !too_long) return;
  if (!closePart()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++progress_.part;
  }
  try {
    openPart();
  } catch (const InvalidInput& e) {
    stop(State::kError, e.what());
    return;
  }
  for (const auto& [topic, record] : sticky_) {
    if (!bag_) return;
    BagRecord again = record;
    again.time = time;
    write(again);
  }
}

void SessionWriter::checkDisk() {
  if (!bag_) return;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if ((now - last_check_).toSec() < options_.check_period) return;
  last_check_ = now;
  const std::string directory = fs::path(stem_).parent_path().string();
  std::uint64_t free = 0;
  try {
    free = options_.free_bytes(directory);
  } catch (const std::exception& e) {  // the disk went away
    fail(e.what());
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_.free_bytes = free;
  }
  if (free >= options_.min_free_bytes) return;
  if (closePart())
    stop(State::kDiskFull,
         format(
             "%.0f MB free in %s, less than min_free_mb = %.0f: the bag is closed and complete up "
             "to here; delete old bags or set ~directory to another disk, then start again",
             static_cast<double>(free) / kMegabyte, directory.c_str(),
             static_cast<double>(options_.min_free_bytes) / kMegabyte));
}

void SessionWriter::openPart() {
  const std::string path = partPath(progress_.part);
  active_path_ = path + ".active";
  for (const std::string& existing : {path, active_path_})
    if (fs::exists(existing))
      throw InvalidInput(
          format("%s exists and is not overwritten; choose another name", existing.c_str()));
  auto bag = std::make_unique<rosbag::Bag>();
  try {
    bag->open(active_path_, rosbag::bagmode::Write);
  } catch (const std::exception& e) {
    throw InvalidInput(format("cannot write %s: %s; set ~directory to a place where you may write",
                              active_path_.c_str(), e.what()));
  }
  bag_ = std::move(bag);
  part_start_ = ros::Time();
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.bag = path;
  progress_.message = "writing " + path;
}

bool SessionWriter::closePart() {
  const std::string path = partPath(progress_.part);
  try {
    bag_->close();
    if (fs::exists(path)) throw InvalidInput(path + " appeared meanwhile and is not overwritten");
    fs::rename(active_path_, path);
  } catch (const std::exception& e) {
    fail(e.what());
    return false;
  }
  bag_.reset();
  std::error_code ignored;
  closed_bytes_ += fs::file_size(path, ignored);
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.parts.push_back(path);
  progress_.bytes = closed_bytes_;
  return true;
}

void SessionWriter::stop(State state, const std::string& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.state = state;
  progress_.message = message;
}

void SessionWriter::fail(const std::string& what) {
  // A bag whose close() throws throws from its destructor, too, and that ends the process. It is
  // given up instead; its buffers (1 MB) stay until the node ends.
  try {
    bag_->close();
  } catch (const std::exception&) {
    [[maybe_unused]] const rosbag::Bag* given_up = bag_.release();
  }
  bag_.reset();
  stop(State::kError, format("cannot write %s: %s; what was written so far is kept there: free the "
                             "disk, then `rosbag reindex %s`",
                             active_path_.c_str(), what.c_str(), active_path_.c_str()));
}

}  // namespace raven_correction
