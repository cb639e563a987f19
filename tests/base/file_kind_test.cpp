// What a file is by its content, whether it is text, and the words where another kind was wanted.
#include "base/file_kind.hpp"

#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;

namespace {

std::string utf16le(const std::string& text, bool mark) {
  std::string out = mark ? "\xFF\xFE" : "";
  for (const char c : text) out += {c, '\0'};
  return out;
}

}  // namespace

TEST_CASE("a kind is known by content, not by the name of the file") {
  CHECK(kind_of_content("# machine: m\naxis,x_mm,sense,reading\nX,0,EX,1\n") == FileKind::measurements);
  CHECK(kind_of_content("\xEF\xBB\xBF"
                        "axis;x_mm;sense;reading\n") == FileKind::measurements);
  CHECK(kind_of_content("axis,sense,approach,p_mm,value_um\n") == FileKind::map);
  CHECK(kind_of_content("# a comment\n[[effect]]\nid = \"offset\"\n") == FileKind::model);
  CHECK(kind_of_content("name = \"m\"\nconfiguration = \"TXYZ\"\n[axis.X]\n") == FileKind::machine);
  CHECK(kind_of_content("[identity]\nmachine = \"m\"\n[configuration]\n") == FileKind::parameters);
  CHECK(kind_of_content("# plane: XY\nangle_deg,deviation_um,direction,run\n") == FileKind::circle_test);
  CHECK(kind_of_content("line,station_mm,reading\n") == FileKind::surface);
  CHECK(kind_of_content("angle_deg,x_um\n") == FileKind::spindle_test);
  CHECK(kind_of_content("# speed_rpm: 3000\ntime_s;z_um\n") == FileKind::spindle_test);
  CHECK(kind_of_content("time_s,z_um\n") == FileKind::other);
  CHECK(kind_of_content("ECSDUMP 1 0000\n") == FileKind::memory);
  CHECK(kind_of_content("PK\x03\x04....[Content_Types].xml") == FileKind::workbook);
  CHECK(kind_of_content("PK\x03\x04....mimetypeapplication/vnd.oasis.opendocument.spreadsheet") == FileKind::workbook);
  CHECK(kind_of_content("PK\x03\x04....picture.bmp") == FileKind::archive);
  CHECK(kind_of_content("%PDF-1.7") == FileKind::pdf);
  CHECK(kind_of_content("<?xml version=\"1.0\"?>\n<T><PLANE TEST_PLANE=\"XY\"/></T>") == FileKind::ball_bar);
  CHECK(kind_of_content("<T><FEATURE NAME=\"AF_SQUARENESS\">1</FEATURE></T>") == FileKind::ball_bar);
  CHECK(kind_of_content("<html>") == FileKind::other);
  CHECK(kind_of_content("0;1\n2;3\n") == FileKind::other);
  CHECK(kind_of_content("") == FileKind::other);
}

TEST_CASE("a measurement with notes about its set-up and tool is no file of lengths") {
  CHECK(kind_of_content("# set_up: 1\n# tool: 2\naxis,x_mm,sense,reading\n") == FileKind::measurements);
}

TEST_CASE("a file of another kind is named for what it is, with the command that takes it") {
  const Folder folder;
  const std::string map = folder.with("map.csv", "# machine: m\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\n");
  const auto refused = must_fail(read_file_of(FileKind::measurements, map));
  CHECK(to_text(refused) == map + ":2:1: this is an error map, not a measurement: use `ecs map show " + map + "`");
  CHECK(read_file_of(FileKind::map, map).has_value());
  const auto blank = must(wrong_kind(FileKind::machine, "[[effect]]\n", "my model.toml"));
  CHECK(contains(blank.message, "ecs model diagnose 'my model.toml' DATA"));
  const auto swapped = must(wrong_kind(FileKind::model, "axis,x_mm,sense,reading\n", "x.csv"));
  CHECK(swapped.message == "this is a measurement, not an error model: give MODEL first, then DATA");
}

TEST_CASE("a file that only a module takes is named, with the module's command where there is one") {
  const std::string circle = "# radius_mm: 100\nangle_deg,deviation_um\n0,0\n";
  const auto alone = must(wrong_kind(FileKind::map, circle, "c.csv"));
  CHECK(alone.message == "this is a circular test, not an error map");
  advise(name_of(FileKind::circle_test), "draw {}");
  CHECK(must(wrong_kind(FileKind::map, circle, "c.csv")).message == alone.message + ": draw c.csv");
  advise(name_of(FileKind::circle_test), "");
}

TEST_CASE("a file that nobody knows is left to its reader") {
  CHECK_FALSE(wrong_kind(FileKind::model, "x = 1\n", "m.toml").has_value());
  CHECK_FALSE(wrong_kind(FileKind::measurements, "0;1\n", "m.csv").has_value());
}

TEST_CASE("UTF-16 is recognised by its mark or by its zeros, and the message says what to do") {
  for (const bool mark : {true, false}) {
    const auto why = must(why_no_text(utf16le("name = \"mill\"\n", mark), "m.toml"));
    CHECK(to_text(why) == "m.toml: this is UTF-16: save it as UTF-8");
  }
  CHECK(utf16_order(utf16le("abcd", true)) == std::string("UTF-16LE"));
  CHECK(utf16_order(std::string_view("\0a\0b\0c", 6)) == std::string("UTF-16BE"));
}

TEST_CASE("a NUL byte is named with its line and column") {
  const auto why = must(why_no_text(std::string_view("first\nsec\0nd\n", 13), "p.toml"));
  CHECK(to_text(why).starts_with("p.toml:2:4: a NUL byte (0)"));
  CHECK(why_no_text(std::string_view("\0abc", 4), "p")->column == 1);
}

TEST_CASE("text is left alone, whatever its letters") {
  CHECK_FALSE(why_no_text("", "p"));
  CHECK_FALSE(why_no_text("a\xC3\xA4\r\n\xFF", "p"));
  CHECK_FALSE(why_no_text("\xEF\xBB\xBFname", "p"));
}
