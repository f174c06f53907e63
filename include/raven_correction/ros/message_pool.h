// SPDX-License-Identifier: BSD-3-Clause
// Messages that are published again and again: their memory is used anew once no subscriber in the
// same process holds them, so that the live path does not allocate.
#pragma once

#include <array>
#include <atomic>
#include <boost/make_shared.hpp>
#include <cstddef>

namespace raven_correction {

/// Of one thread.
template <typename Message>
class MessagePool {
 public:
  MessagePool() {
    for (auto& message : messages_) message = boost::make_shared<Message>();
  }

  /// Gives every message the size of this one, the first time only: next() is then assigned
  /// messages of that size without allocation. Before the first next().
  void makeRoomFor(const Message& like) {
    if (has_room_) return;
    has_room_ = true;
    for (auto& message : messages_) *message = like;
  }

  /// A message with any content that nobody else holds. Allocates only when all are held.
  boost::shared_ptr<Message> next() {
    for (std::size_t i = 0; i < messages_.size(); ++i) {
      last_ = (last_ + 1) % messages_.size();
      if (messages_[last_].use_count() == 1) {
        std::atomic_thread_fence(std::memory_order_acquire);  // the last holder has read it
        return messages_[last_];
      }
    }
    return boost::make_shared<Message>();
  }

 private:
  std::array<boost::shared_ptr<Message>, 16> messages_;
  std::size_t last_ = 0;
  bool has_room_ = false;
};

}  // namespace raven_correction
