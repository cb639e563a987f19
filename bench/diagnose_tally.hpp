// Rates over many cases, with their intervals. Does not live here: what counts as right (diagnose_score.hpp).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "diagnose_case.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::bench {

/// Rates of one kind of case.
struct Tally {
  bool blank = false;
  unsigned cases = 0, hits = 0, rival_hits = 0;
  unsigned named = 0, likely = 0;               ///< an effect is proved; one is likely
  unsigned proved = 0;                          ///< blanks: any candidate has an e-value of 100
  unsigned variables = 0, variables_named = 0;  ///< of structure outside the library
  unsigned parameters = 0, within = 0;
  unsigned added = 0, added_well = 0;
  std::map<std::string, std::pair<unsigned, unsigned>> by_effect;  ///< hits, cases
};

/// Seconds of processor time per diagnosis, with its number of readings.
struct Times {
  std::vector<std::pair<double, std::size_t>> each;
};

/// One answer, by the number of readings and the seconds it took.
struct Answer {
  model::Diagnosis diagnosis;
  std::vector<std::string> rival;  ///< names that the rival gave
  bool has_rival = false;
  double seconds = 0.0;
};

/// @return whether the answer is right
bool count(const Case& one, const Answer& answer, Tally& tally);

/// One line for people who look at single cases.
[[nodiscard]] std::string report_line(const std::string& where, const Case& one, const Answer& answer);

void print(const std::string& name, const Tally& tally, bool rival);
void print(const Times& times);

}  // namespace ecs::bench
