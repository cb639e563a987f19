// compile(): the working form gives what the image's values say by definition; what a map lacks is named.
#include <memory>

#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr PerAxis<Approach> kForward{Approach::forward, Approach::forward, Approach::forward};
constexpr PerAxis<Approach> kReverse{Approach::reverse, Approach::reverse, Approach::reverse};

std::unique_ptr<CompiledMap> compiled(const std::vector<std::uint8_t>& image) {
  REQUIRE(check_image(image).fault == ImageFault::none);
  auto map = std::make_unique<CompiledMap>();
  REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
  return map;
}

CompileVerdict verdict_on(const UnitParameters& parameters, const std::vector<PlannedTable>& tables) {
  const auto image = image_of(parameters, tables);
  REQUIRE(check_image(image).fault == ImageFault::none);
  auto map = std::make_unique<CompiledMap>();
  return compile(ImageView(image), *map);
}

/// The definition of one table, read from the image value by value.
double table_value(const ImageView& view, const TableEntry& e, Interpolation interpolation, double p_mm) {
  const auto position_of = [&](std::uint32_t k) { return e.start_mm + k * e.increment_mm; };
  const auto value_of = [&](std::uint32_t k) { return view.value_counts(e.first_value + k) * e.resolution; };
  if (p_mm <= position_of(0)) return value_of(0);
  if (p_mm >= position_of(e.count - 1)) return value_of(e.count - 1);
  std::uint32_t k = 0;
  while (position_of(k + 1) <= p_mm) ++k;
  const double part = (p_mm - position_of(k)) / e.increment_mm;
  if (interpolation == Interpolation::nearest) return part < 0.5 ? value_of(k) : value_of(k + 1);
  return value_of(k) + (value_of(k + 1) - value_of(k)) * part;
}

double component_value(const ImageView& view, Interpolation interpolation, Component c, const Vector3& position_mm,
                       const PerAxis<Approach>& approach) {
  const std::size_t moving = index_of(moving_axis(c));
  for (std::uint32_t i = 0; i < view.table_count(); ++i) {
    const TableEntry e = view.entry(i);
    if (e.component != c || e.declared_zero) continue;
    if (e.approach == Approach::unknown || e.approach == approach[moving])
      return table_value(view, e, interpolation, position_mm[moving]);
  }
  return 0.0;
}

/// Compensation term by term, straight from the rows of the model.
Vector3 by_definition_um(const ImageView& view, const Vector3& position_mm, const PerAxis<Approach>& approach) {
  const UnitParameters p = *view.parameters();
  const Vector3 squareness{p.C0Y_um_per_m, p.B0Z_um_per_m, p.A0Z_um_per_m};
  const TermTable terms = *terms_of(p);
  Vector3 sum{};
  for (const Term& term : terms) {
    const std::size_t l = index_of(term.lever);
    double& to = sum[index_of(term.observed)];
    if (is_squareness(term.component)) {
      to -= term.sign * squareness[index_of(term.component) - kCurves] * position_mm[l] / 1000.0;
      continue;
    }
    const double value = component_value(view, p.interpolation, term.component, position_mm, approach);
    double lever_mm = p.tool_offset_mm[l];
    if (term.uses_coordinate)
      lever_mm += position_mm[l] - p.measurement_lines_mm[index_of(moving_axis(term.component))][l];
    to += term.has_lever ? term.sign * p.angular_scale * value * lever_mm / 1000.0 : term.sign * value;
  }
  return sum;
}

PlannedTable random_table(Component c, Approach approach) {
  PlannedTable t{c, approach, number_up_to(1000.0), number_between(5.0, 200.0), number_between(0.001, 0.02), {}};
  const auto length = *rc::gen::inRange<std::size_t>(1, 30);
  t.counts = *rc::gen::container<std::vector<std::int16_t>>(length, rc::gen::arbitrary<std::int16_t>());
  return t;
}

std::vector<PlannedTable> random_map() {
  std::vector<PlannedTable> tables;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    const int kind = *rc::gen::inRange(0, 4);
    if (kind == 0) tables.push_back(random_table(c, Approach::unknown));
    if (kind == 1 || kind == 2) {
      tables.push_back(random_table(c, Approach::reverse));
      tables.push_back(random_table(c, Approach::forward));
    }
    if (kind == 3) tables.push_back({c, Approach::unknown, 0.0, 1.0, 1.0, {}});
  }
  return tables;
}

UnitParameters one_axis(Interpolation interpolation) {
  UnitParameters p;
  set_configuration(p, "TX");
  p.interpolation = interpolation;
  return p;
}

double x_at(const CompiledMap& map, double p_mm, const PerAxis<Approach>& approach = kForward) {
  return compensation_um_at(map, {p_mm, 0.0, 0.0}, approach)[0];
}

}  // namespace

TEST_CASE("the compiled map is the definition, term by term, for any map, chain, convention, scope and tool") {
  CHECK(rc::check([] {
    const UnitParameters parameters = random_parameters();
    const auto image = image_of(parameters, random_map());
    const auto map = compiled(image);
    const ImageView view(image);
    for (int pose = 0; pose < 10; ++pose) {
      Vector3 position_mm = vector_up_to(3000.0);
      for (double& mm : position_mm) mm += 0.000'123;  // off the points where two nearest values are equally near
      PerAxis<Approach> approach{};
      for (auto& a : approach) a = *rc::gen::element(Approach::forward, Approach::reverse);
      const Vector3 fast = compensation_um_at(*map, position_mm, approach);
      const Vector3 slow = by_definition_um(view, position_mm, approach);
      for (std::size_t o = 0; o < kAxes; ++o) RC_ASSERT(std::abs(fast[o] - slow[o]) < 1e-9);
    }
  }));
}

TEST_CASE("the nearest value acts for less than half an increment to either side, in both directions") {
  const auto map = compiled(
      image_of(one_axis(Interpolation::nearest), {{Component::EXX, Approach::unknown, -40.0, 20.0, 1.0, {10, -6, 8}}}));
  for (const auto& approach : {kForward, kReverse}) {
    CHECK(x_at(*map, -1000.0, approach) == 10.0);
    CHECK(x_at(*map, -30.001, approach) == 10.0);
    CHECK(x_at(*map, -29.999, approach) == -6.0);
    CHECK(x_at(*map, -10.001, approach) == -6.0);
    CHECK(x_at(*map, -9.999, approach) == 8.0);
    CHECK(x_at(*map, 1000.0, approach) == 8.0);
  }
}

TEST_CASE("parameters hold squareness errors, the output compensates them") {
  UnitParameters p{.C0Y_um_per_m = 16.0, .B0Z_um_per_m = -38.8, .A0Z_um_per_m = -66.93};
  const auto map = compiled(image_of(p, with_zeros({})));
  // error E_X = −C0Y·Y + B0Z·Z, E_Y = −A0Z·Z at Y = −1.4 m, Z = −1 m: +22.4 + 38.8 and −66.93
  const Vector3 compensation_um = compensation_um_at(*map, {-4100.0, -1400.0, -1000.0}, kForward);
  CHECK(compensation_um[0] == Approx(-61.2));
  CHECK(compensation_um[1] == Approx(66.93));
  CHECK(compensation_um[2] == 0.0);
}

TEST_CASE("a map that lacks a needed component is refused, and the component named") {
  UnitParameters p;
  auto tables = with_zeros({});
  CHECK(verdict_on(p, tables).fault == Fault::none);  // declared zero is not missing
  for (std::size_t i = 0; i < tables.size(); ++i) {
    auto without = tables;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
    const CompileVerdict verdict = verdict_on(p, without);
    if (components_needed(p).contains(tables[i].component)) {
      CHECK(verdict.fault == Fault::map_not_for_parameters);
      CHECK(verdict.missing == tables[i].component);
    } else {
      CHECK(verdict.fault == Fault::none);
    }
  }
}

TEST_CASE("a map with one approach of a needed component only is refused") {
  const auto p = one_axis(Interpolation::linear);
  const PlannedTable forward{Component::EXX, Approach::forward, 0.0, 1.0, 1.0, {1, 2}};
  CHECK(verdict_on(p, {forward}).fault == Fault::map_not_for_parameters);
  const PlannedTable zero_reverse{Component::EXX, Approach::reverse, 0.0, 1.0, 1.0, {}};
  CHECK(verdict_on(p, {forward, zero_reverse}).fault == Fault::none);
}

TEST_CASE("a map compiled over another leaves nothing of it") {
  auto map = std::make_unique<CompiledMap>();
  UnitParameters p{.C0Y_um_per_m = 100.0, .tool_offset_mm = {10.0, 20.0, 30.0}};
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c)
    tables.push_back({static_cast<Component>(c), Approach::unknown, 0.0, 1.0, 1.0, {100, -100, 50}});
  const auto first = image_of(p, tables);
  REQUIRE(compile(ImageView(first), *map).fault == Fault::none);
  const auto second = image_of(UnitParameters{}, with_zeros({}));
  REQUIRE(compile(ImageView(second), *map).fault == Fault::none);
  CHECK(compensation_um_at(*map, {3.0, 4.0, 5.0}, kForward) == Vector3{});
  CHECK(compensation_um_at(*map, {3.0, 4.0, 5.0}, kReverse) == Vector3{});
}

TEST_CASE("a full map of five modules compiles within its storage") {
  UnitParameters p;
  p.memory_modules = 5;
  std::vector<PlannedTable> tables;
  for (std::size_t t = 0; t < 36; ++t)
    tables.push_back({static_cast<Component>(t / 2), t % 2 == 0 ? Approach::forward : Approach::reverse, 0.0, 1.0, 1.0,
                      std::vector<std::int16_t>(t == 35 ? 160'000 - 35 * 4444 : 4444, static_cast<std::int16_t>(t))});
  const auto map = compiled(image_of(p, tables));
  CHECK(compensation_um_at(*map, {1e6, 0.0, 0.0}, kForward)[0] ==
        0.0 + 12.0 + 24.0);  // EXX, EXY, EXZ: tables 0, 12, 24
}
