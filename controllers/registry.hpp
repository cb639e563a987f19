// The controller formats that the program knows.
#pragma once

#include <span>

#include "controllers/format.hpp"

namespace ecs::controllers {

/// In the order of menus and documentation.
[[nodiscard]] std::span<const ControllerFormat* const> controller_formats();

/// Nothing if no format has this id.
[[nodiscard]] const ControllerFormat* controller_format(std::string_view id);

/// The first format that recognises decoded text; nothing if none does.
[[nodiscard]] const ControllerFormat* recognised_format(std::string_view text);

/// Its row of the table "What each holds" in docs/controllers.md.
[[nodiscard]] std::string holds_row(const ControllerFormat& format);

}  // namespace ecs::controllers
