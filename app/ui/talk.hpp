// Messages, questions with yes or no, and the progress of long work, drawn.
#pragma once

#include <string>

#include "app/ui/cells.hpp"
#include "app/ui/keys.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// Rows that a message takes, 1 to `most`: a screen gives it those and the rest to what stands above.
[[nodiscard]] int rows_of_message(const Message& message, int columns, int most);
/// Whole words over as many rows as `area` has; the last one ends in "… F2" where it is not all (cells.hpp).
void draw_message(Canvas& canvas, const Area& area, const Message& message);

enum class Reply { none, yes, no };
/// y: yes; n, Esc: no; Enter is neither: nobody confirms by accident.
[[nodiscard]] Reply reply_to(const Key& key);
/// A box in the middle of `area`.
void draw_question(Canvas& canvas, const Area& area, const Question& question);
/// Nothing where none waits.
void draw_question(Canvas& canvas, const Area& area, const Asking& asking);
/// @return whether the key was for the question: while one waits, all are
bool answers(Asking& asking, const Key& key);

/// "sending the map  [=======>      ]  62 %  8 s left"; a negative `seconds_left` is not shown.
void draw_progress(Canvas& canvas, const Area& area, int row, const std::string& label, double part,
                   double seconds_left = -1.0);

}  // namespace ecs::app
