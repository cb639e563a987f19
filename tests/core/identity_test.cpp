// Whom an image is addressed to: a unit takes its own and no other.
#include <string>

#include <doctest/doctest.h>

#include "core/memory_image.hpp"
#include "tests/core/support/image_of.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

using IdentifiedImage = std::vector<std::uint8_t>;

UnitParameters machine_of(const char* chain) {
  UnitParameters parameters;
  for (std::size_t i = 0; i < 5; ++i) parameters.configuration[i] = chain[i];
  return parameters;
}

IdentifiedImage image_for(const ImageIdentity& identity, const UnitParameters& parameters) {
  IdentifiedImage image = image_of(parameters, {{Component::EXX, Approach::unknown, 0.0, 10.0, 0.01, {1, 2, 3}}});
  write_identity(image, identity);
  seal_image(image);
  return image;
}

const UnitParameters kMill = machine_of("TXYZ");
const std::uint32_t kOfMill = configuration_hash(kMill);

IdentityFault taken(const IdentifiedImage& image, const IdentifiedImage& active = {}) {
  return identity_fault(image, own_identity("M-1", active));
}

}  // namespace

TEST_CASE("an identity comes back from the image as it went in") {
  const IdentifiedImage image = image_for({"M-1", "moving column mill", 0x12345678}, kMill);
  CHECK(check_image(image).fault == ImageFault::none);
  CHECK(ImageView(image).identity() == ImageIdentity{"M-1", "moving column mill", 0x12345678});
}

TEST_CASE("a long name of a machine is cut between two characters") {
  const std::string name(39, 'x');
  CHECK(machine_in_identity(name + "y") == name + "y");
  CHECK(machine_in_identity(name + "ü") == name);
  const IdentifiedImage image = image_for({"0123456789ABCDEFG", name + "ü", 0}, kMill);
  CHECK(ImageView(image).identity() == ImageIdentity{"0123456789ABCDEF", name, 0});
}

TEST_CASE("a unit without a map takes what is addressed to its serial number") {
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, kMill)) == IdentityFault::none);
  CHECK(taken(image_for({"M-1", "", kOfMill}, kMill)) == IdentityFault::none);
  CHECK(taken(image_for({"M-2", "mill", kOfMill}, kMill)) == IdentityFault::other_serial_number);
  CHECK(taken(image_for({"", "mill", kOfMill}, kMill)) == IdentityFault::not_stated);
  CHECK(taken(image_for({"M\x1b", "mill", kOfMill}, kMill)) == IdentityFault::not_stated);
  CHECK(taken(image_for({"M-1", "mill", kOfMill + 1}, kMill)) == IdentityFault::other_configuration);
}

TEST_CASE("a unit keeps to the machine and the configuration of the map it holds") {
  const IdentifiedImage active = image_for({"M-1", "mill", kOfMill}, kMill);
  const UnitParameters other = machine_of("XTYZ");
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, kMill), active) == IdentityFault::none);
  CHECK(taken(image_for({"M-1", "lathe", kOfMill}, kMill), active) == IdentityFault::other_machine);
  CHECK(taken(image_for({"M-1", "", kOfMill}, kMill), active) == IdentityFault::other_machine);
  CHECK(taken(image_for({"M-1", "mill", configuration_hash(other)}, other), active) ==
        IdentityFault::other_configuration);
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, other), active) == IdentityFault::none);  // addressed on purpose
}

TEST_CASE("parameters alone bind a unit to no machine") {
  IdentifiedImage parameters_alone = image_of(kMill, {});
  write_identity(parameters_alone, {"M-1", "mill", kOfMill});
  seal_image(parameters_alone);
  const UnitParameters other = machine_of("XTYZ");
  CHECK(taken(image_for({"M-1", "lathe", configuration_hash(other)}, other), parameters_alone) == IdentityFault::none);
}

TEST_CASE("configuration, axes and convention make another hash, polarity and limits do not") {
  CHECK(configuration_hash(machine_of("XTYZ")) != kOfMill);
  UnitParameters changed = kMill;
  changed.axis_present[2] = false;
  CHECK(configuration_hash(changed) != kOfMill);
  changed = kMill;
  changed.convention = Convention::as_printed;
  CHECK(configuration_hash(changed) != kOfMill);
  changed = kMill;
  changed.axes[0].compensation_polarity = -1;
  changed.tool_offset_mm[2] = 100.0;
  CHECK(configuration_hash(changed) == kOfMill);
}

TEST_CASE("an image of format 1 is sound and read, and names nobody") {
  const UnitParameters parameters = kMill;
  const ImagePlan plan{1, 2, 4, kFormatWithoutIdentity};
  IdentifiedImage image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, 2, 0.0, 10.0, 0.01});
  write_value(image, 0, 7);
  write_value(image, 1, -7);
  write_header(image, "text");
  seal_image(image);
  CHECK(image.size() == 64 + 512 + 40 + 4 + 4);
  CHECK(check_image(image).fault == ImageFault::none);
  const ImageView view(image);
  CHECK_FALSE(view.identity().has_value());
  CHECK(view.entry(0).count == 2);
  CHECK(view.value_counts(1) == -7);
  CHECK(view.header() == "text");
  CHECK(identity_fault(image, own_identity("M-1", {})) == IdentityFault::not_stated);
}

TEST_CASE("every identity fault has its words, short enough for the answer of a unit") {
  for (std::uint8_t f = 0; f <= static_cast<std::uint8_t>(IdentityFault::other_configuration); ++f) {
    CHECK(text_of(static_cast<IdentityFault>(f)) != "unknown");
    CHECK(text_of(static_cast<IdentityFault>(f)).size() + 10 <= 80);
  }
}
