// Fits an error model to measurements:  fitted model.toml data.csv
#include <cstdio>

#include "laser/measurement_set.hpp"
#include "model/fit/fit.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: fitted MODEL.toml DATA.csv\n");
    return 2;
  }
  const auto model = ecs::model::read_model(argv[1]);
  const auto set = ecs::laser::read_measurement_set(argv[2]);
  if (!model || !set) {
    std::fprintf(stderr, "%s\n", ecs::to_text(model ? set.error() : model.error()).c_str());
    return 3;
  }
  const auto fit = ecs::model::fit(*model, ecs::model::observations_of(*set, *model, std::nullopt));
  if (!fit) {
    std::fprintf(stderr, "%s\n", ecs::to_text(fit.error()).c_str());
    return 3;
  }
  for (const auto& effect : fit->effects)
    for (const auto& parameter : effect.parameters)
      std::printf("%s %s: %g +- %g %s\n", to_text(effect.effect).c_str(), parameter.name.c_str(), parameter.value,
                  parameter.sigma.value_or(0.0), parameter.unit.c_str());
}
