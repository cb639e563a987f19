#include "kinematics/joint_chain.hpp"

#include <algorithm>

namespace ecs::kinematics {

std::optional<std::string> fault_of(std::string_view configuration) {
  for (const char letter : configuration)
    if (letter != 'T' && !joint_of(letter)) return "one T and different letters of XYZABC, such as \"XYACTZ\"";
  if (std::count(configuration.begin(), configuration.end(), 'T') != 1)
    return "exactly one T: letters before it carry the workpiece, letters after it the tool";
  std::size_t linear = 0, rotary = 0;
  for (std::size_t i = 0; i < configuration.size(); ++i) {
    const auto joint = joint_of(configuration[i]);
    if (!joint) continue;
    if (configuration.find(configuration[i], i + 1) != std::string_view::npos) return "each letter once";
    ++(is_rotary(*joint) ? rotary : linear);
  }
  if (rotary > kMostRotary) return "at most two rotary axes of A, B, C";
  if (linear == 0) return "at least one linear axis of X, Y, Z";
  return std::nullopt;
}

std::optional<JointChain> joint_chain_of(std::string_view configuration) {
  if (fault_of(configuration)) return std::nullopt;
  JointChain chain;
  const std::size_t tool = configuration.find('T');
  for (std::size_t i = tool; i-- > 0;) chain.joints[chain.count++] = {*joint_of(configuration[i]), true};
  for (const char letter : configuration.substr(tool + 1)) chain.joints[chain.count++] = {*joint_of(letter), false};
  return chain;
}

std::string linear_configuration(std::string_view configuration) {
  std::string letters;
  for (const char letter : configuration)
    if (const auto joint = joint_of(letter); !joint || !is_rotary(*joint)) letters += letter;
  return letters;
}

std::string iso_notation(const JointChain& chain) {
  std::string text = "w";
  bool before_bed = true;
  for (const ChainJoint& one : chain) {
    if (before_bed && !one.carries_workpiece) {
      text += " b";
      before_bed = false;
    }
    text += ' ';
    text += letter_of(one.joint);
    if (one.carries_workpiece) text += '\'';
  }
  return text + (before_bed ? " b t" : " t");
}

}  // namespace ecs::kinematics
