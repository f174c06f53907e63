// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/run_record.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "raven_correction/error.h"

namespace raven_correction {
namespace {

namespace fs = std::filesystem;

/// One byte at a time of the polynomial 0x04C11DB7, most significant bit first.
class Checksum {
 public:
  void add(const unsigned char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) add(bytes[i]);
    length_ += count;
  }
  std::uint32_t finish() {
    for (std::uint64_t n = length_; n > 0; n >>= 8) add(static_cast<unsigned char>(n & 0xFFU));
    return ~crc_;
  }

 private:
  void add(unsigned char byte) { crc_ = (crc_ << 8) ^ table()[(crc_ >> 24) ^ byte]; }
  static const std::array<std::uint32_t, 256>& table() {
    static const std::array<std::uint32_t, 256> entries = [] {
      std::array<std::uint32_t, 256> all{};
      for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t value = i << 24;
        for (int bit = 0; bit < 8; ++bit)
          value = (value << 1) ^ ((value & 0x80000000U) != 0 ? 0x04C11DB7U : 0U);
        all[i] = value;
      }
      return all;
    }();
    return entries;
  }

  std::uint32_t crc_ = 0;
  std::uint64_t length_ = 0;
};

InputFile inputFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InvalidInput(format("%s: cannot be read for its checksum", path.c_str()));
  Checksum checksum;
  InputFile input{path, 0, 0};
  std::array<char, 65536> buffer{};
  while (file.read(buffer.data(), buffer.size()) || file.gcount() > 0) {
    const auto count = static_cast<std::size_t>(file.gcount());
    checksum.add(reinterpret_cast<const unsigned char*>(buffer.data()), count);
    input.bytes += count;
  }
  input.checksum = checksum.finish();
  return input;
}

/// What a YAML file says, without what it explains.
std::string withoutComments(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string::npos && line[first] != '#') out += line + "\n";
  }
  return out;
}

}  // namespace

std::uint32_t posixChecksum(const unsigned char* bytes, std::size_t count) {
  Checksum checksum;
  checksum.add(bytes, count);
  return checksum.finish();
}

std::vector<InputFile> inputFiles(const std::vector<std::string>& paths) {
  std::vector<InputFile> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(inputFile(path));
      continue;
    }
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(path))
      if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    for (const std::string& name : names)
      files.push_back(inputFile((fs::path(path) / name).string()));
  }
  return files;
}

std::string packageVersion() { return RAVEN_CORRECTION_VERSION; }

void appendProvenance(const RunRecord& run, HtmlDocument& document) {
  document.section("Where this comes from");
  document.paragraph("To make this report again:");
  document.verbatim(run.command);
  HtmlTable settings;
  settings.rows.push_back({"package", "raven_correction " + packageVersion()});
  if (!run.made_at.empty()) settings.rows.push_back({"made at", run.made_at});
  for (const auto& [name, value] : run.settings) settings.rows.push_back({name, value});
  document.table(settings);
  HtmlTable inputs;
  inputs.caption =
      "Inputs. The checksum is that of the program cksum: if it differs, so does the file.";
  inputs.header = {"file", "bytes", "checksum"};
  inputs.numeric = {false, true, true};
  for (const InputFile& input : run.inputs)
    inputs.rows.push_back(
        {input.path, std::to_string(input.bytes), std::to_string(input.checksum)});
  if (!inputs.rows.empty()) document.table(inputs);
  if (run.configuration.empty()) return;
  document.paragraph("The configuration, as it was read (comments left out):");
  document.verbatim(withoutComments(run.configuration));
}

}  // namespace raven_correction
