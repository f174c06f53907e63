// SPDX-License-Identifier: BSD-3-Clause
// Looks at a page as a program would: parses it with an XML parser that is not ours, and finds
// numbers in it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "support/temporary_directory.h"

namespace raven_correction {

/// What check_page.py finds wrong with a page; empty: nothing.
inline std::string problemsOf(const std::string& page) {
  const TemporaryDirectory folder;
  const std::string file = folder.path() + "/page.html";
  std::ofstream(file) << page;
  const std::string command = "/usr/bin/python3 test/report/check_page.py " + file + " 2>/dev/null";
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "python3 does not start";
  std::string found;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) found += buffer.data();
  const int code = pclose(pipe);
  if (code == 0) return "";
  return found.empty() ? "check_page.py failed" : found;
}

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The page with every space that does not break as a common one, for looking words up.
inline std::string withPlainSpaces(std::string page) {
  const std::string unbroken = "\xC2\xA0";
  for (std::size_t at = page.find(unbroken); at != std::string::npos; at = page.find(unbroken, at))
    page.replace(at, unbroken.size(), " ");
  return page;
}

/// The table whose caption begins like this, in XML; empty if there is none.
inline std::string tableUnder(const std::string& page, const std::string& caption) {
  const std::size_t begin = page.find("<caption>" + caption);
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("</table>", begin) - begin);
}

/// A whole row of a table: a name, then numbers.
inline std::string rowOf(const std::string& name, const std::vector<std::string>& numbers) {
  std::string row = "<td>" + name + "</td>";
  for (const std::string& number : numbers) row += "<td class=\"number\">" + number + "</td>";
  return row + "</tr>";
}

/// The pictures of a page, each with its title.
struct Picture {
  std::string title, svg;
};
inline std::vector<Picture> picturesOf(const std::string& page) {
  std::vector<Picture> pictures;
  for (std::size_t at = page.find("role=\"img\""); at != std::string::npos;
       at = page.find("role=\"img\"", at + 1)) {
    const std::size_t title = page.find("<title>", at) + 7;
    const std::size_t next = page.find("role=\"img\"", at + 1);
    pictures.push_back({page.substr(title, page.find("</title>", title) - title),
                        page.substr(at, next == std::string::npos ? next : next - at)});
  }
  return pictures;
}

/// Labels of the ticks beside the y axis, from its bottom.
inline std::vector<std::string> labelsAtEnd(const std::string& svg) {
  std::vector<std::string> labels;
  for (std::size_t at = svg.find("text-anchor=\"end\""); at != std::string::npos;
       at = svg.find("text-anchor=\"end\"", at + 1)) {
    const std::size_t begin = svg.find('>', at) + 1;
    labels.push_back(svg.substr(begin, svg.find('<', begin) - begin));
  }
  return labels;
}

}  // namespace raven_correction
