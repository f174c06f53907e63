// SPDX-License-Identifier: BSD-3-Clause
// Where the numbers of a report come from: command, inputs with checksums, configuration, version.
// Enough to make the same report again, and to notice that an input is not the same any more.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "raven_correction/report/html_document.h"

namespace raven_correction {

struct InputFile {
  std::string path;  ///< as the user wrote it
  std::uint64_t bytes = 0;
  std::uint32_t checksum = 0;  ///< as printed by cksum(1)
};

struct RunRecord {
  std::string command;  ///< that makes the report again
  std::string made_at;  ///< UTC, for people
  std::vector<InputFile> inputs;
  std::vector<std::pair<std::string, std::string>> settings;  ///< name and value
  std::string configuration;                                  ///< a whole file; may be empty
};

/// CRC-32 of POSIX, that of the program cksum, so that anybody can check it.
/// Source: IEEE Std 1003.1-2017, utility cksum
std::uint32_t posixChecksum(const unsigned char* bytes, std::size_t count);

/// Every file of the inputs: a file as it is, of a directory the regular files in it by name.
/// @throws InvalidInput  a file cannot be read
std::vector<InputFile> inputFiles(const std::vector<std::string>& paths);

/// Of this package, "0.1.0".
std::string packageVersion();

/// The last section of every report.
void appendProvenance(const RunRecord& run, HtmlDocument& document);

}  // namespace raven_correction
