// SPDX-License-Identifier: BSD-3-Clause
// A report as one XHTML file that needs nothing else: style inline, no script, no reference to
// anything outside, readable on narrow screens and when printed. Figures are figure.h.
#pragma once

#include <string>
#include <vector>

#include "raven_correction/report/figure.h"

namespace raven_correction {

/// How a statement is meant; said by a word and a sign, and only then by colour.
enum class Tone { kGood, kNotice, kWarning };

/// A number that one looks for first.
struct KeyNumber {
  std::string name;    ///< "median position error"
  std::string value;   ///< "5.68 to 1.96 mm"
  std::string detail;  ///< "95 % interval ..."; may be empty
};

struct HtmlTable {
  std::string caption;  ///< how to read it
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /// One per column: numbers are aligned at the right; shorter than the header: text.
  std::vector<bool> numeric;
  std::vector<std::size_t> emphasised;  ///< rows in bold
};

class HtmlDocument {
 public:
  HtmlDocument(std::string title, std::string subtitle);

  /// The box on top: what was found, and what to do next.
  void verdict(Tone tone, const std::string& headline, const std::vector<std::string>& findings,
               const std::vector<std::string>& next_steps);
  void keyNumbers(const std::vector<KeyNumber>& numbers);
  void section(const std::string& title);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// A paragraph that must not be overlooked, with its word in front.
  void note(Tone tone, const std::string& text);
  void table(const HtmlTable& table);
  void figure(const Figure& figure);
  /// As it stands, in a typewriter face: a command, a file.
  void verbatim(const std::string& text);

  /// The whole file. Well-formed XML, and HTML for browsers.
  std::string text() const;

 private:
  std::string title_, subtitle_, body_;
  std::vector<std::string> sections_;
  int figures_ = 0;
};

}  // namespace raven_correction
