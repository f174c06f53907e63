// SPDX-License-Identifier: BSD-3-Clause
// What every program of fuzz/ is made of: it names good inputs and reads one input. libFuzzer,
// which is linked to it, changes inputs to reach new code; a sanitizer or an exception other than
// InvalidInput ends it. Included by the one source of a program.
#pragma once

#include <ros/serialization.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "raven_correction/error.h"

namespace raven_correction {
namespace fuzz {

using Bytes = std::vector<std::uint8_t>;

// --- of the program
// ---------------------------------------------------------------------------------
/// Inputs that are good, to start from.
std::vector<Bytes> goodInputs();
/// @throws InvalidInput  the input is refused; anything else is a finding
void read(const Bytes& input);

// --- for the program
// --------------------------------------------------------------------------------
inline Bytes contentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The package's folder config/.
inline std::filesystem::path configFolder() {
  const char* const root = std::getenv("RAVEN_ROOT");  // ./run sets it
  return std::filesystem::path(root == nullptr ? "." : root) / "config";
}

inline std::string textOf(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }
inline Bytes bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

/// Several readers share a program: the first byte of an input chooses.
inline Bytes forReader(std::uint8_t reader, Bytes input) {
  input.insert(input.begin(), reader);
  return input;
}

template <typename Message>
Bytes serialised(const Message& message) {
  Bytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// A file in memory, for what reads files by their name.
class MemoryFile {
 public:
  MemoryFile() : file_(memfd_create("fuzz", 0)) {
    if (file_ < 0) throw std::runtime_error("memfd_create");
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  void set(const std::uint8_t* data, std::size_t size) {
    if (ftruncate(file_, 0) != 0 || pwrite(file_, data, size, 0) != static_cast<ssize_t>(size))
      throw std::runtime_error("memory file");
  }
  void set(const Bytes& bytes) { set(bytes.data(), bytes.size()); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// Good inputs become the first files of the corpus, the folder that the program is called with.
inline void writeCorpus(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::size_t number = 0;
  for (const Bytes& input : goodInputs()) {
    std::ofstream file(folder / ("good_" + std::to_string(number++)), std::ios::binary);
    file.write(reinterpret_cast<const char*>(input.data()),
               static_cast<std::streamsize>(input.size()));
  }
}

}  // namespace fuzz
}  // namespace raven_correction

/// libFuzzer calls this before it looks at its arguments. What is no option is the folder of the
/// corpus, or a file: an input to be read again.
extern "C" int LLVMFuzzerInitialize(const int* count, char*** arguments) {
  for (int i = 1; i < *count; ++i) {
    const char* const argument = (*arguments)[i];
    if (argument[0] == '-') continue;
    if (!std::filesystem::is_regular_file(argument)) raven_correction::fuzz::writeCorpus(argument);
    break;
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    raven_correction::fuzz::read({data, data + size});
  } catch (const raven_correction::InvalidInput&) {  // NOLINT: it was refused, as it should be
  }
  return 0;
}
