// SPDX-License-Identifier: BSD-3-Clause
#include "raven_correction/report/html_document.h"

#include <gtest/gtest.h>

#include "raven_correction/error.h"
#include "raven_correction/report/run_record.h"
#include "report/page.h"

namespace raven_correction {
namespace {

TEST(HtmlDocument, IsWellFormedAndEscapesEverything) {
  const std::string nasty = "<script>alert('&')</script> \"x\" \xFF";
  HtmlDocument document(nasty, nasty);
  for (const Tone tone : {Tone::kGood, Tone::kNotice, Tone::kWarning}) {
    document.verdict(tone, nasty, {nasty}, {nasty});
    document.note(tone, nasty);
  }
  document.keyNumbers({{nasty, nasty, nasty}});
  document.section(nasty);
  document.paragraph(nasty);
  document.list({nasty});
  document.verbatim(nasty);
  HtmlTable table;
  table.caption = nasty;
  table.header = {nasty, nasty};
  table.rows = {{nasty, nasty}};
  table.emphasised = {0};
  document.table(table);
  document.section("second");
  const std::string page = document.text();
  EXPECT_EQ(problemsOf(page), "");
  EXPECT_FALSE(contains(page, "<script>"));
  EXPECT_EQ(count(page, "<h2 id="), 2u);
}

TEST(HtmlDocument, SaysItsToneInWords) {
  HtmlDocument document("t", "s");
  document.note(Tone::kWarning, "text");
  document.note(Tone::kGood, "text");
  EXPECT_TRUE(contains(document.text(), "Attention: "));
  EXPECT_TRUE(contains(document.text(), "Good: "));
}

TEST(HtmlDocument, KeepsAUnitOnTheLineOfItsNumber) {
  HtmlDocument document("t", "s");
  document.paragraph("from 5.68 mm to 64 % (1 to 2 %), 3 motions");
  EXPECT_TRUE(
      contains(document.text(), "from 5.68\xC2\xA0mm to 64\xC2\xA0% (1 to 2\xC2\xA0%), 3 motions"));
}

// printf 123456789 | cksum says 930766865 9.
TEST(Checksum, IsThatOfCksum) {
  const std::string text = "123456789";
  const auto* const bytes = reinterpret_cast<const unsigned char*>(text.data());
  EXPECT_EQ(posixChecksum(bytes, text.size()), 930766865u);
  EXPECT_EQ(posixChecksum(bytes, 0), 4294967295u);
}

TEST(InputFiles, AreThoseOfADirectoryByName) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() + "/b.csv") << "123456789";
  std::ofstream(folder.path() + "/a.csv") << std::string(200000, 'x');
  const std::vector<InputFile> files = inputFiles({folder.path()});
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].path, folder.path() + "/a.csv");
  EXPECT_EQ(files[0].bytes, 200000u);
  EXPECT_EQ(files[1].checksum, 930766865u);
  EXPECT_THROW(inputFiles({folder.path() + "/none"}), InvalidInput);
}

TEST(Provenance, NamesCommandVersionAndFiles) {
  HtmlDocument document("t", "s");
  RunRecord run;
  run.command = "./run offline diagnose 'my session' --report r.html";
  run.inputs = {{"my session/a.csv", 9, 930766865}};
  run.settings = {{"seed", "7"}};
  run.configuration = "a: <1>\n";
  appendProvenance(run, document);
  const std::string page = document.text();
  EXPECT_EQ(problemsOf(page), "");
  for (const char* const part :
       {"./run offline diagnose &#39;my session&#39;", "930766865", "seed", "a: &lt;1&gt;"})
    EXPECT_TRUE(contains(page, part)) << part;
  EXPECT_TRUE(contains(page, "raven_correction " + packageVersion()));
}

}  // namespace
}  // namespace raven_correction
