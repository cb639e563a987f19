// One case: a set, the user's base model, what is hidden in it, its noise, and what a diagnosis may answer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/foreign/effects.hpp"

namespace foreign {

struct Noise {
  std::string law = "white";  ///< white, rounded, ar, heavy or outliers
  double sigma_um = 0.5;      ///< standard deviation of a reading, rounding included
  double correlation = 0.0;   ///< of neighbouring readings of a run, law ar
  double step_um = 0.0;       ///< of the display, law rounded
};

struct Case {
  std::string row;
  std::uint64_t seed = 0;
  Setup setup;
  std::vector<Term> base;    ///< true terms that the user's model has, linear parameters free
  std::string free_base;     ///< id of the base term whose nonlinear or curve parameters are free; may be empty
  std::vector<Term> hidden;  ///< effects of the library
  std::string structure;     ///< of outside and bad_run: its kind
  Column hidden_um;          ///< what is hidden, all of it
  Noise noise;
  Column readings_um;
  std::vector<double> snr;  ///< of each hidden effect, or of the structure: rms of its part that the base model
                            ///< cannot take, over sigma
  double oracle_p = 1.0;    ///< of a least-squares fit that knows the hidden effects
  bool oracle_right = true;
  std::vector<std::string> required;  ///< rivals that must stand in the group
  std::vector<std::string> allowed;   ///< rivals that may
};

/// Draws until the case is one that a perfect method could answer; deterministic by row and seed.
[[nodiscard]] Case draw_case(const std::string& row, std::uint64_t seed);
[[nodiscard]] const std::vector<std::string>& row_names();
/// Standard deviations that the readings allow for the parameters of hidden[index] (Cramér 1946), under the names of
/// parameters_of(); the place of a step has none.
[[nodiscard]] std::map<std::string, double> parameter_sigmas(const Case& drawn, std::size_t index);

/// Sets oracle_p and oracle_right: whether every hidden effect is the best beside the others, and how sure it is.
void ask_oracle(Case& drawn);

/// Readings of the noise law alone.
[[nodiscard]] Noise draw_noise(Random& random);
[[nodiscard]] Column draw_noise_um(Random& random, const Setup& setup, const Noise& noise);
/// Rows as least squares wants them: divided by sigma, the correlation inside runs taken out (Cochrane and Orcutt).
[[nodiscard]] Column whitened(const Setup& setup, const Noise& noise, const Column& values);

/// Structure outside the library, in units of its own. `kind` in 0 … outside_kinds() − 1.
struct Structure {
  std::string kind;
  Column um;
};
[[nodiscard]] int outside_kinds();
[[nodiscard]] Structure draw_outside(Random& random, const Setup& setup, int kind);
[[nodiscard]] Structure draw_bad_run(Random& random, const Setup& setup);

}  // namespace foreign
