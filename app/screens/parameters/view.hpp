// The parts of the parameters screen as pictures: the list of a group, the panel below it, findings, comparison, the
// beginning.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/ui/widgets.hpp"
#include "commissioning/parameters/controller.hpp"

namespace ecs::app {

/// A value being typed or chosen in its row.
struct ValueEdit {
  std::string key;
  TextLine text;
  bool choosing = false;  ///< Space, left and right go through choices_of(key)
  std::string refusal;    ///< why the value that was entered is refused; empty: none was
};

/// Which file, how many changes, which machine, which unit; what fits into `columns`.
[[nodiscard]] std::string about(const ParametersController& controller, int columns);

/// @return where the terminal's cursor belongs; row −1: nowhere
CellPosition draw_parameters(Canvas& canvas, const Area& area, const ParametersController& controller,
                             const std::vector<ParameterRow>& rows, const ListPlace& place,
                             const std::optional<ValueEdit>& edit);

/// The key under the cursor: what stands against it, what it accepts, its help.
void draw_key_panel(Canvas& canvas, const Area& area, const ParametersController& controller, const std::string& key,
                    const std::string& refusal);

void draw_findings(Canvas& canvas, const Area& area, const ParametersController& controller, const ListPlace& place);
void draw_finding_panel(Canvas& canvas, const Area& area, const ParametersController& controller,
                        const ListPlace& place);

void draw_compared(Canvas& canvas, const Area& area, const ParametersController& controller, const ListPlace& place);
void draw_compared_panel(Canvas& canvas, const Area& area, const ParametersController& controller,
                         const ListPlace& place);

/// A rule with a title, then texts in their tones, whole words; F2 shows what there are no rows for.
struct PanelText {
  std::string text;
  Tone tone = Tone::plain;
};
void draw_panel(Canvas& canvas, const Area& area, const std::string& title, const std::vector<PanelText>& texts);

}  // namespace ecs::app
