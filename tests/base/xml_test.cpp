// XML of others: what is read, and what is refused because it is hostile.
#include "base/xml/xml.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

namespace {

std::string nested(std::size_t depth) {
  std::string text;
  for (std::size_t i = 0; i < depth; ++i) text += "<a>";
  text += "x";
  for (std::size_t i = 0; i < depth; ++i) text += "</a>";
  return text;
}

std::string refused_xml(const std::string& text) { return to_text(must_fail(parsed_xml(text, "a.xml"))); }

}  // namespace

TEST_CASE("elements have their names without prefixes, attributes, own text and lines") {
  const XmlElement root =
      must(parsed_xml("<?xml version=\"1.0\"?>\n<r xmlns:q=\"urn:q\" unit=\"&lt;mm&gt;\">\n <q:v NAME='a'> 1.5 "
                      "</q:v>\n <v><![CDATA[2 < 3]]></v>"
                      "<v/></r>",
                      "a.xml"));
  CHECK(root.name == "r");
  CHECK(attribute_of(root, "unit") == "<mm>");
  CHECK(attribute_of(root, "none").empty());
  REQUIRE(root.children.size() == 3);
  CHECK(root.children[0].text == "1.5");
  CHECK(root.children[0].line == 3);
  CHECK(attribute_of(root.children[0], "NAME") == "a");
  CHECK(root.children[1].text == "2 < 3");
  CHECK(element_below(&root, {"v"}) == &root.children[0]);
  CHECK(element_below(&root, {"v", "none"}) == nullptr);
  CHECK(element_below(nullptr, {"v"}) == nullptr);
  CHECK(all_text_of(root) == "1.52 < 3");
}

TEST_CASE("UTF-16 with its mark is read") {
  std::string text = "\xFF\xFE";
  for (const char c : std::string("<r>5</r>")) text += {c, '\0'};
  CHECK(must(parsed_xml(text, "a.xml")).text == "5");
}

TEST_CASE("text that is no XML is refused with its line") {
  CHECK(contains(refused_xml("<a>\n<b></a>"), "a.xml:2: not XML: "));
  for (const char* text : {"", "0 1 2\n", "<a>", "<a/><b/>", "<a>\x01</a>"})
    CHECK(contains(refused_xml(text), "not XML: "));
}

TEST_CASE("entities, files to be fetched, deep nesting and large documents are refused") {
  CHECK(contains(refused_xml("<!DOCTYPE a [<!ENTITY x \"xxxxxxxxxx\"><!ENTITY y \"&x;&x;&x;\">]><a>&y;</a>"),
                 "a document type declaration"));
  CHECK(contains(refused_xml("<!DOCTYPE a SYSTEM \"file:///etc/passwd\"><a/>"), "a document type declaration"));
  CHECK(contains(refused_xml("<a>&undefined;</a>"), "not XML: "));
  CHECK(parsed_xml(nested(200), "a.xml").has_value());
  CHECK(contains(refused_xml(nested(10'000)), "not XML: "));
  CHECK(contains(refused_xml("<a>" + std::string(kMostXmlBytes, ' ') + "</a>"), "expected at most 16777216"));
}
