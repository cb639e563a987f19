// What the structures of structure.cpp are drawn with: the line that one is put on, and draws that several share.
#pragma once

#include <functional>
#include <map>

#include "ecs_emulator/hidden_cases/structure.hpp"

namespace ecs::emulator {

class StructureDrawing {
 public:
  using Value = std::function<double(const Stop&)>;

  StructureDrawing(Random& random, const Scene& scene, const Ground& ground);

  /// Its value at the stops of the line's sense, its variables as far as the data show them.
  [[nodiscard]] Structure with(std::vector<std::string> variables, std::string text, const Value& value) const;

  /// 0 … 1 along the line.
  [[nodiscard]] double part(const Stop& stop) const;
  /// Column of the coordinate of an axis.
  [[nodiscard]] static std::string column_of(Axis axis);
  [[nodiscard]] std::string position() const { return column_of(axis); }
  [[nodiscard]] double mean(const Value& value) const;

  [[nodiscard]] std::map<int, double> draw_for_each_run();
  /// Waves along the line that its targets can show, no whole number of them; 0 where it has too few targets.
  [[nodiscard]] double draw_waves();
  /// A sensor, not the air's, if there is one.
  [[nodiscard]] std::optional<std::size_t> draw_sensor();

  Random& random;
  const Scene& scene;
  const Ground& ground;
  Sense sense = Sense::EX;  ///< of the line
  Axis axis = Axis::X;
  const std::vector<double>* places_mm = nullptr;  ///< targets of the line
  int runs = 1;
  double duration_s = 0.0;
};

}  // namespace ecs::emulator
