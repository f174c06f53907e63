// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/html_document.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include "html_style.h"
#include "raven_correction/error.h"
#include "raven_correction/report/figure_html.h"
#include "raven_correction/report/xml_text.h"

namespace raven_correction {
namespace {

const char* className(Tone tone) {
  return tone == Tone::kGood ? "good" : tone == Tone::kNotice ? "notice" : "warning";
}

/// A sign and a word, so that no colour is needed.
const char* signOf(Tone tone) {
  return tone == Tone::kGood     ? "\xE2\x9C\x93 Good: "  // check mark
         : tone == Tone::kNotice ? "\xE2\x84\xB9 Note: "  // i
                                 : "\xE2\x9A\xA0 Attention: ";
}

/// Keeps a unit on the line of its number. @return escaped
std::string proseHtml(const std::string& text) {
  static constexpr const char* kUnits[] = {"%", "mm", "deg", "ms", "s", "Hz"};
  std::string out = xmlText(text);
  for (std::size_t at = out.find(' '); at != std::string::npos; at = out.find(' ', at + 1)) {
    if (at == 0 || std::isdigit(static_cast<unsigned char>(out[at - 1])) == 0) continue;
    const std::size_t end = std::min(out.size(), out.find_first_of(" ,.;:)&<", at + 1));
    const std::string next = out.substr(at + 1, end - at - 1);
    if (std::find(std::begin(kUnits), std::end(kUnits), next) == std::end(kUnits)) continue;
    out.replace(at, 1, "\xC2\xA0");  // a space that does not break
  }
  return out;
}

std::string listHtml(const char* tag, const std::vector<std::string>& items) {
  std::string html = format("<%s>", tag);
  for (const std::string& item : items) html += "<li>" + proseHtml(item) + "</li>";
  return html + format("</%s>\n", tag);
}

std::string cellHtml(const char* tag, const std::string& text, bool numeric) {
  return format("<%s%s>", tag, numeric ? " class=\"number\"" : "") + xmlText(text) +
         format("</%s>", tag);
}

}  // namespace

HtmlDocument::HtmlDocument(std::string title, std::string subtitle)
    : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

void HtmlDocument::verdict(Tone tone, const std::string& headline,
                           const std::vector<std::string>& findings,
                           const std::vector<std::string>& next_steps) {
  body_ += format("<div class=\"verdict %s\">\n<h2><span class=\"sign\">%s</span>", className(tone),
                  signOf(tone)) +
           proseHtml(headline) + "</h2>\n";
  if (!findings.empty()) body_ += listHtml("ul", findings);
  if (!next_steps.empty()) body_ += "<h3>What to do next</h3>\n" + listHtml("ol", next_steps);
  body_ += "</div>\n";
}

void HtmlDocument::keyNumbers(const std::vector<KeyNumber>& numbers) {
  body_ += "<dl class=\"numbers\">\n";
  for (const KeyNumber& number : numbers) {
    body_ += "<div><dt>" + xmlText(number.name) + "</dt><dd>" + proseHtml(number.value) + "</dd>";
    if (!number.detail.empty())
      body_ += "<dd class=\"detail\">" + proseHtml(number.detail) + "</dd>";
    body_ += "</div>\n";
  }
  body_ += "</dl>\n";
}

void HtmlDocument::section(const std::string& title) {
  sections_.push_back(title);
  body_ += format("<h2 id=\"section-%zu\">", sections_.size()) + xmlText(title) + "</h2>\n";
}

void HtmlDocument::paragraph(const std::string& text) {
  body_ += "<p>" + proseHtml(text) + "</p>\n";
}

void HtmlDocument::list(const std::vector<std::string>& items) { body_ += listHtml("ul", items); }

void HtmlDocument::note(Tone tone, const std::string& text) {
  body_ +=
      format("<p class=\"note %s\"><span class=\"sign\">%s</span>", className(tone), signOf(tone)) +
      xmlText(text) + "</p>\n";
}

void HtmlDocument::table(const HtmlTable& table) {
  const auto numeric = [&](std::size_t column) {
    return column < table.numeric.size() && table.numeric[column];
  };
  body_ += "<div class=\"scroll\"><table>\n";
  if (!table.caption.empty()) body_ += "<caption>" + xmlText(table.caption) + "</caption>\n";
  if (!table.header.empty()) {
    body_ += "<thead><tr>";
    for (std::size_t c = 0; c < table.header.size(); ++c)
      body_ += cellHtml("th", table.header[c], numeric(c));
    body_ += "</tr></thead>\n";
  }
  body_ += "<tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const bool bold =
        std::find(table.emphasised.begin(), table.emphasised.end(), r) != table.emphasised.end();
    body_ += bold ? "<tr class=\"emphasised\">" : "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c)
      body_ += cellHtml("td", table.rows[r][c], numeric(c));
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void HtmlDocument::figure(const Figure& figure) { body_ += figureHtml(figure, ++figures_); }

void HtmlDocument::verbatim(const std::string& text) {
  body_ += "<pre>" + xmlText(text) + "</pre>\n";
}

std::string HtmlDocument::text() const {
  std::string navigation;
  for (std::size_t i = 0; i < sections_.size(); ++i)
    navigation +=
        format("<li><a href=\"#section-%zu\">", i + 1) + xmlText(sections_[i]) + "</a></li>";
  std::string html =
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>" +
      xmlText(title_) + "</title>\n<style>" + kHtmlStyle + "</style>\n</head>\n<body>\n";
  html += "<header><h1>" + xmlText(title_) + "</h1>\n<p class=\"subtitle\">" + xmlText(subtitle_) +
          "</p></header>\n";
  // The verdict comes first, then where to find what, then the rest.
  const std::size_t first = body_.find("<h2 id=\"section-1\"");
  const std::string top = body_.substr(0, first);
  html += "<main>\n" + top;
  if (!navigation.empty())
    html += "<nav aria-label=\"Sections\"><ul>" + navigation + "</ul></nav>\n";
  if (first != std::string::npos) html += body_.substr(first);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace raven_correction
