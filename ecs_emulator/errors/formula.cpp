#include "ecs_emulator/errors/formula.hpp"

#include <algorithm>
#include <cmath>

#include <muParser.h>

#include "base/parser_message.hpp"
#include "base/text.hpp"

namespace ecs::emulator {

struct Formula::Parser {
  mu::Parser parser;
};

Formula::Formula(std::unique_ptr<Parser> parser) : parser_(std::move(parser)) {}
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;
Formula::~Formula() = default;

Result<Formula> Formula::compile(const std::string& expression, Variables& variables) {
  if (assigns(expression))  // would change the variables of every other formula
    return problem(ProblemKind::bad_input, "formula \"{}\": expected a value, got an assignment; == compares",
                   expression);
  auto parser = std::make_unique<Parser>();
  try {
    const std::map<std::string, double*> named{{"p", &variables.p}, {"d", &variables.d}, {"x", &variables.x},
                                               {"y", &variables.y}, {"z", &variables.z}, {"t", &variables.t},
                                               {"f", &variables.f}, {"m", &variables.m}, {"u", &variables.u}};
    for (const auto& [name, address] : named) parser->parser.DefineVar(name, address);
    for (auto& [name, value] : variables.temperatures) parser->parser.DefineVar("T_" + name, &value);
    parser->parser.DefineConst("pi", 3.14159265358979323846);
    parser->parser.SetExpr(expression);
    static_cast<void>(parser->parser.Eval());
  } catch (const mu::ParserError& error) {
    return problem(ProblemKind::bad_input, "formula \"{}\", character {}: {}", expression, error.GetPos() + 1,
                   without_position(error.GetMsg()));
  }
  return Formula(std::move(parser));
}

double Formula::raw() const { return parser_->parser.Eval(); }

double Formula::value() const {
  const double value = raw();
  return std::isfinite(value) ? value : 0.0;
}

double ErrorCurve::value(const Variables& variables) const {
  if (formula) return formula->value();
  const double p_mm = variables.p;
  const auto side = [&](const CurvePoint& at) { return variables.d < 0.0 ? at.reverse : at.forward; };
  if (p_mm <= points.front().p_mm) return side(points.front());
  if (p_mm >= points.back().p_mm) return side(points.back());
  const auto above = std::upper_bound(points.begin(), points.end(), p_mm,
                                      [](double position, const CurvePoint& point) { return position < point.p_mm; });
  const auto below = above - 1;
  return std::lerp(side(*below), side(*above), (p_mm - below->p_mm) / (above->p_mm - below->p_mm));
}

}  // namespace ecs::emulator
