#include "modules/lengths/curves.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"

namespace ecs::model {
namespace {

constexpr int kGridOfCurve = 241;      ///< on which curves are made orthonormal
constexpr double kNothingLeft = 1e-8;  ///< of the largest pivot: what the convention took away

double part_of(const std::array<double, 2>& travel_mm, double position_mm) {
  return std::clamp((position_mm - travel_mm[0]) / (travel_mm[1] - travel_mm[0]), 0.0, 1.0);
}

/// Legendre polynomials up to `degree` at a part of the travel.
Eigen::VectorXd reversal_shapes(int degree, double part) {
  Eigen::VectorXd out(degree + 1);
  const double t = 2.0 * part - 1.0;
  out(0) = 1.0;
  if (degree > 0) out(1) = t;
  for (int n = 1; n < degree; ++n) out(n + 1) = ((2.0 * n + 1.0) * t * out(n) - n * out(n - 1)) / (n + 1.0);
  return out;
}

}  // namespace

SplineCurves::SplineCurves(const std::array<double, 2>& travel_mm, double reference_mm, int intervals,
                           bool without_slope)
    : travel_mm_(travel_mm), intervals_(intervals), reference_mm_(reference_mm) {
  const Eigen::Index count = intervals_ + 3;
  slope_ = Eigen::VectorXd::Zero(count);
  at_reference_ = splines(reference_mm);
  Eigen::VectorXd p(kGridOfCurve);
  Eigen::MatrixXd values(kGridOfCurve, count);
  for (int i = 0; i < kGridOfCurve; ++i) {
    p(i) = std::lerp(travel_mm[0], travel_mm[1], i / (kGridOfCurve - 1.0));
    values.row(i) = splines(p(i)).transpose();
  }
  if (without_slope) {
    const Eigen::VectorXd centred = p.array() - p.mean();
    slope_ = values.transpose() * centred / centred.squaredNorm();
  }
  for (int i = 0; i < kGridOfCurve; ++i) values.row(i) = anchored(p(i)).transpose();
  values /= std::sqrt(static_cast<double>(kGridOfCurve));
  combine_ = row_space_of(values, kNothingLeft).back;
}

Eigen::VectorXd SplineCurves::splines(double position_mm) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(intervals_ + 3);
  const double place = part_of(travel_mm_, position_mm) * intervals_;
  const int cell = std::min(static_cast<int>(place), intervals_ - 1);
  const double t = place - cell, s = 1.0 - t;
  out(cell) = s * s * s / 6.0;
  out(cell + 1) = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
  out(cell + 2) = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0;
  out(cell + 3) = t * t * t / 6.0;
  return out;
}

Eigen::VectorXd SplineCurves::anchored(double position_mm) const {
  const double p = std::clamp(position_mm, travel_mm_[0], travel_mm_[1]);
  const double r = std::clamp(reference_mm_, travel_mm_[0], travel_mm_[1]);
  return splines(p) - at_reference_ - slope_ * (p - r);
}

Eigen::VectorXd SplineCurves::at(double position_mm) const { return combine_.transpose() * anchored(position_mm); }

Result<LengthMachine> length_machine(const params::Machine& machine) {
  const auto chain = params::chain_of(machine);
  if (!chain || chain->axis_count() != kAxes)
    return problem(ProblemKind::bad_input,
                   "expected a machine with the axes X, Y and Z, found the configuration {}: lengths identify "
                   "three-axis machines",
                   machine.configuration);
  LengthMachine out;
  out.chain = *chain;
  out.lines_mm = params::measurement_lines_of(machine);
  for (std::size_t a = 0; a < kAxes; ++a) {
    out.travel_mm[a] = machine.axes[a]->travel_mm;
    out.reference_mm[a] = machine.axes[a]->datum_mm;
  }
  return out;
}

MachineCurves::MachineCurves(const LengthMachine& machine, const CurveSettings& settings)
    : machine_(machine),
      terms_(*terms_of(machine.chain, Convention::iso, CurveKind::measured)),
      reversal_degree_(settings.reversal_degree) {
  for (const Term& term : terms_)
    for (const Vector3& tool_mm : settings.tools_mm)
      if (!term.has_lever || term.uses_coordinate || tool_mm[index_of(term.lever)] != 0.0)
        acts_[index_of(term.component)] = true;
  for (const Axis axis : kAllAxes) {
    const std::size_t a = index_of(axis);
    const double span_mm = machine.travel_mm[a][1] - machine.travel_mm[a][0];
    intervals_[a] = std::max(1, static_cast<int>(std::lround(span_mm / settings.knots_mm[a])));
    for (const bool without_slope : {false, true})
      splines_[a][without_slope ? 1 : 0] =
          SplineCurves(machine.travel_mm[a], machine.reference_mm[a], intervals_[a], without_slope);
  }
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    Block& block = blocks_[c];
    block.first = size_;
    if (!acts_[c] || settings.zero[c]) continue;
    if (is_squareness(component)) {
      block.even = 1;
    } else {
      block.even = splines_[index_of(moving_axis(component))][is_straightness(component) ? 1 : 0].size();
      block.odd = reversal_degree_ < 0 ? 0 : reversal_degree_ + 1;
    }
    size_ += block.size();
  }
}

Eigen::VectorXd MachineCurves::value_row(Component c, double position_mm, int approach) const {
  const Block& b = block(c);
  Eigen::VectorXd row(b.size());
  if (b.size() == 0) return row;
  if (is_squareness(c)) {
    row(0) = 1.0;
    return row;
  }
  const std::size_t a = index_of(moving_axis(c));
  row.head(b.even) = splines_[a][is_straightness(c) ? 1 : 0].at(position_mm);
  if (b.odd > 0)
    row.tail(b.odd) = 0.5 * approach * reversal_shapes(reversal_degree_, part_of(machine_.travel_mm[a], position_mm));
  return row;
}

double MachineCurves::lever_mm(const Term& term, const Vector3& position_mm, const Vector3& tool_mm) const {
  const std::size_t l = index_of(term.lever);
  if (is_squareness(term.component)) return position_mm[l];
  double lever = tool_mm[l];
  if (term.uses_coordinate) lever += position_mm[l] - machine_.lines_mm[index_of(moving_axis(term.component))][l];
  return lever;
}

Eigen::MatrixXd MachineCurves::error_rows(const Vector3& position_mm, const PerAxis<int>& approach,
                                          const Vector3& tool_mm) const {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(kAxes, size_);
  std::array<Eigen::VectorXd, kComponents> values;
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    if (block(component).size() == 0) continue;
    const std::size_t a = is_squareness(component) ? 0 : index_of(moving_axis(component));
    values[c] = value_row(component, position_mm[a], approach[a]);
  }
  for (const Term& term : terms_) {
    const Block& b = block(term.component);
    if (b.size() == 0) continue;
    const double lever = term.has_lever ? lever_mm(term, position_mm, tool_mm) / kMmPerM : 1.0;
    rows.row(static_cast<Eigen::Index>(index_of(term.observed))).segment(b.first, b.size()) +=
        term.sign * lever * values[index_of(term.component)].transpose();
  }
  return rows;
}

Eigen::MatrixXd MachineCurves::volume_rows(const Vector3& position_mm, const PerAxis<int>& approach,
                                           const Vector3& tool_mm) const {
  return error_rows(position_mm, approach, tool_mm) - error_rows(machine_.reference_mm, {0, 0, 0}, tool_mm);
}

std::vector<VolumePlace> volume_places(const LengthMachine& machine, int count) {
  std::vector<VolumePlace> places;
  const auto at = [&](std::size_t a, int i) {
    return std::lerp(machine.travel_mm[a][0], machine.travel_mm[a][1], i / (count - 1.0));
  };
  for (const int side : {1, -1})
    for (int x = 0; x < count; ++x)
      for (int y = 0; y < count; ++y)
        for (int z = 0; z < count; ++z) places.push_back({{at(0, x), at(1, y), at(2, z)}, {side, side, side}});
  return places;
}

Eigen::MatrixXd volume_weight(const MachineCurves& curves, const std::vector<Vector3>& tools_mm, int count) {
  const auto places = volume_places(curves.machine(), count);
  Eigen::MatrixXd stacked(static_cast<Eigen::Index>(3 * places.size() * tools_mm.size()), curves.size());
  Eigen::Index row = 0;
  for (const Vector3& tool_mm : tools_mm)
    for (const VolumePlace& place : places) {
      stacked.middleRows(row, 3) = curves.volume_rows(place.position_mm, place.approach, tool_mm);
      row += 3;
    }
  return stacked.transpose() * stacked / static_cast<double>(places.size() * tools_mm.size());
}

NuisanceColumns nuisance_of(const LengthTest& test, Eigen::Index first) {
  NuisanceColumns out;
  out.first = out.end = first;
  for (const LengthReading& r : test.readings) {
    if (test.set_ups[r.set_up].instrument != LengthInstrument::interferometer &&
        out.station.emplace(std::pair(r.set_up, r.tool), out.end).second)
      out.end += 3;
    if (test.set_ups[r.set_up].instrument == LengthInstrument::points) {
      if (out.rotation.emplace(r.set_up, out.end).second) out.end += 3;
    } else {
      const bool of_bar = test.bar_um && test.set_ups[r.set_up].instrument == LengthInstrument::ball_bar;
      if (of_bar && !out.bar) out.bar = out.end++;
      if (out.zero.emplace(std::tuple(r.set_up, r.run, r.tool), of_bar ? *out.bar : out.end).second && !of_bar)
        ++out.end;
    }
    if (out.scale.emplace(r.set_up, out.end).second) ++out.end;
  }
  return out;
}

PlacementRows placement_rows(const Vector3& along, const Eigen::Vector3d& point_mm, const Eigen::Vector3d& from_mm) {
  const Eigen::Vector3d lever_m = (point_mm - from_mm) / kMmPerM;
  return {-eigen(along).transpose(), lever_m.cross(eigen(along)).transpose()};
}

Linearised linearised(const LengthTest& test, const MachineCurves& curves, const NuisanceColumns& nuisance,
                      const Eigen::VectorXd& values) {
  const auto n = static_cast<Eigen::Index>(test.readings.size());
  Linearised out{Eigen::MatrixXd::Zero(n, nuisance.end), Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, 3)};
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Vector3d> first_point;
  for (Eigen::Index i = 0; i < n; ++i) {
    const LengthReading& r = test.readings[static_cast<std::size_t>(i)];
    const LengthSetUp& set_up = test.set_ups[r.set_up];
    const Eigen::MatrixXd error = curves.error_rows(r.position_mm, r.approach, test.tools[r.tool].offset_mm);
    const Eigen::Vector3d point = eigen(point_of(test, r));
    Eigen::Vector3d along;
    double metres = 0.0;
    if (set_up.instrument == LengthInstrument::points) {
      along = eigen(r.along);
      const auto first = first_point.emplace(std::pair(r.set_up, std::size_t{0}), point).first->second;
      metres = (point - first).dot(along) / kMmPerM;
      const Eigen::Index station = nuisance.station.at({r.set_up, r.tool}), turn = nuisance.rotation.at(r.set_up);
      const PlacementRows rigid = placement_rows(r.along, point, first);
      out.columns.row(i).segment(station, 3) = rigid.translation;
      out.columns.row(i).segment(turn, 3) = rigid.rotation;
      out.nominal_um(i) = along.dot(error * values.head(curves.size())) +
                          rigid.translation * values.segment(station, 3) + rigid.rotation * values.segment(turn, 3);
    } else if (set_up.instrument == LengthInstrument::interferometer) {
      along = eigen(set_up.place);
      const auto first = first_point.emplace(std::pair(r.set_up, r.tool), point).first->second;
      metres = (point - first).dot(along) / kMmPerM;
      out.nominal_um(i) = along.dot(error * values.head(curves.size()));
    } else {
      const Eigen::Index station = nuisance.station.at({r.set_up, r.tool});
      const Eigen::Vector3d nominal = point - eigen(set_up.place);
      const Eigen::Vector3d actual =
          nominal + (error * values.head(curves.size()) - values.segment(station, 3)) / kUmPerMm;
      along = actual.normalized();
      metres = nominal.norm() / kMmPerM;
      out.nominal_um(i) = (actual.norm() - nominal.norm()) * kUmPerMm;
      out.columns.row(i).segment(station, 3) = -along.transpose();
    }
    out.direction.row(i) = along.transpose();
    out.columns.row(i).head(curves.size()) = along.transpose() * error;
    const Eigen::Index scale = nuisance.scale.at(r.set_up);
    out.columns(i, scale) = metres;
    double zero_um = 0.0;
    if (set_up.instrument != LengthInstrument::points) {
      const Eigen::Index zero = nuisance.zero.at({r.set_up, r.run, r.tool});
      out.columns(i, zero) = 1.0;
      zero_um = values(zero);
    }
    out.nominal_um(i) += zero_um + metres * values(scale);
  }
  return out;
}

}  // namespace ecs::model
