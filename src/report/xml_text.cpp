// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/xml_text.h"

#include <cstddef>

namespace raven_correction {
namespace {

constexpr char kReplacement[] = "\xEF\xBF\xBD";  // U+FFFD

/// Length of the well-formed UTF-8 sequence of a character that XML allows at `i`; 0 if there is
/// none. Source: RFC 3629, section 4; XML 1.0, section 2.2
std::size_t sequenceLength(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
  };
  const auto follows = [&](std::size_t k) { return (byte(k) & 0xC0U) == 0x80U; };
  const unsigned first = byte(i), second = byte(i + 1), third = byte(i + 2);
  if (first < 0x80U) return first >= 0x20U || first == '\n' || first == '\t' ? 1 : 0;
  if (first >= 0xC2U && first <= 0xDFU) return follows(i + 1) ? 2 : 0;
  if (first >= 0xE0U && first <= 0xEFU) {
    if (!follows(i + 1) || !follows(i + 2)) return 0;
    if (first == 0xE0U && second < 0xA0U) return 0;                     // overlong
    if (first == 0xEDU && second >= 0xA0U) return 0;                    // half of a pair
    if (first == 0xEFU && second == 0xBFU && third >= 0xBEU) return 0;  // U+FFFE, U+FFFF
    return 3;
  }
  if (first >= 0xF0U && first <= 0xF4U) {
    if (!follows(i + 1) || !follows(i + 2) || !follows(i + 3)) return 0;
    if (first == 0xF0U && second < 0x90U) return 0;
    if (first == 0xF4U && second >= 0x90U) return 0;
    return 4;
  }
  return 0;
}

}  // namespace

std::string xmlText(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequenceLength(text, i);
    if (length == 0) {
      out += kReplacement;
      ++i;
      continue;
    }
    switch (text[i]) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out.append(text, i, length);
    }
    i += length;
  }
  return out;
}

}  // namespace raven_correction
