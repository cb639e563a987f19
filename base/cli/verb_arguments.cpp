#include "base/cli/verb_arguments.hpp"

namespace ecs::cli {

template <class Value>
Value& VerbArguments::own(Value preset) {
  return std::get<Value>(own_.emplace_back(std::in_place_type<Value>, std::move(preset)));
}

const std::string& VerbArguments::text(std::string name, std::string help, Need need, std::string preset) {
  std::string& value = own(std::move(preset));
  add({std::move(name), &value, std::move(help), need});
  return value;
}

const std::string& VerbArguments::output_file(std::string name, std::string help, Need need) {
  std::string& value = own(std::string());
  Verb::output_file(name, value, help, need);
  return value;
}

const std::vector<std::string>& VerbArguments::texts(std::string name, std::string help, Need need) {
  auto& values = own(std::vector<std::string>());
  add({std::move(name), &values, std::move(help), need});
  return values;
}

const double& VerbArguments::number(std::string name, std::string help, double preset, Need need, double least,
                                    double most) {
  double& value = own(preset);
  add({std::move(name), &value, std::move(help), need, least, most});
  return value;
}

const std::optional<double>& VerbArguments::optional_number(std::string name, std::string help) {
  auto& value = own(std::optional<double>());
  Verb::number(name, value, help);
  return value;
}

const int& VerbArguments::integer(std::string name, std::string help, int preset, int least, int most, Need need) {
  int& value = own(preset);
  Verb::integer(name, value, help, least, most, need);
  return value;
}

const std::string& VerbArguments::choice(std::string name, std::vector<std::string> words, std::string help, Need need,
                                         std::string preset) {
  std::string& value = own(std::move(preset));
  Verb::choice(name, value, std::move(words), help, need);
  return value;
}

const bool& VerbArguments::flag(std::string name, std::string help) {
  bool& value = own(false);
  add({std::move(name), &value, std::move(help)});
  return value;
}

Access VerbArguments::uses_link() {
  Verb::uses_link();
  return Access::reads;
}

Access VerbArguments::may_write_to_unit() {
  uses_link();
  takes_arm_code();
  return Access::reads;
}

Access VerbArguments::writes_to_unit() {
  Verb::writes_to_unit();
  return Access::writes;
}

}  // namespace ecs::cli
