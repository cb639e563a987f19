#include "modules/fleet/manifest.hpp"

#include <doctest/doctest.h>

namespace ecs::commissioning {
namespace {

const ManifestColumns kTwoColumns{{"id", "data"}, {"batch"}};

Result<Manifest> manifest_of(const std::string& text) {
  return Manifest::parse(text, "fleet.csv", "/fleet", kTwoColumns);
}

TEST_CASE("a manifest takes its columns in any order and leaves others alone") {
  const auto manifest =
      manifest_of("\xEF\xBB\xBF# of the night\ndata,site,id\n\na.csv,\"Hall 1, west\",m1\r\nb.csv,,m2");
  REQUIRE(manifest);
  REQUIRE(manifest->size() == 2);
  CHECK(manifest->row(0)->cells == std::vector<std::string>{"m1", "a.csv", ""});
  CHECK(manifest->row(1)->id() == "m2");
  CHECK(manifest->row(1)->line == 5);
  CHECK(manifest->from_folder("sets/a.csv") == "/fleet/sets/a.csv");
}

TEST_CASE("a manifest without a needed column or without rows is refused with its line") {
  CHECK(manifest_of("id,batch\nm1,b\n").error().message.find("found no data") != std::string::npos);
  CHECK(manifest_of("# x\nid,dta\nm1,a.csv\n").error().message.find("did you mean data") != std::string::npos);
  CHECK(manifest_of("# x\nid,dta\nm1,a.csv\n").error().line == 2);
  CHECK(manifest_of("id,data,id\nm1,a,b\n").error().message.find("found id twice") != std::string::npos);
  CHECK_FALSE(manifest_of("id,data\n"));
  CHECK_FALSE(manifest_of(""));
}

TEST_CASE("a wrong row of a manifest spoils no other") {
  const auto manifest = manifest_of("id,data\nm1,a.csv,b.csv\n,a.csv\nm3,\n\"m4,a.csv\nm5,a.csv\n");
  REQUIRE(manifest);
  CHECK(manifest->row(0).error().message.find("expected 2 cells") != std::string::npos);
  CHECK(manifest->row(1).error().message.find("id: expected a value") != std::string::npos);
  CHECK(manifest->row(2).error().line == 4);
  CHECK_FALSE(manifest->row(3));
  CHECK(manifest->row(4)->id() == "m5");
}

TEST_CASE("rows of a manifest with the id of an earlier one are known with its line") {
  const auto manifest = manifest_of("id,data\nm1,a.csv\nm2,b.csv\nm1,c.csv\nm1,d.csv\n");
  REQUIRE(manifest);
  CHECK_FALSE(manifest->doubles_line(0));
  CHECK_FALSE(manifest->doubles_line(1));
  CHECK(manifest->doubles_line(2) == 2);
  CHECK(manifest->doubles_line(3) == 2);
}

}  // namespace
}  // namespace ecs::commissioning
