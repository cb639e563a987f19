// The error model beside the measurements of a report: fitted, diagnosed, predicted against achieved.
// Does not live here: how it is shown (model_sections.cpp).
#pragma once

#include "app/report/content.hpp"

namespace ecs::app {

/// Adds model and diagnosis to the content, where a model or a diagnosis was given. Without --data the readings are
/// those before compensation of the senses and axes on which the model's effects act; of all, if these are none.
[[nodiscard]] Result<void> add_model(VerbContext& context, const ReportArguments& arguments, const ReportFiles& files,
                                     ReportContent& content);

}  // namespace ecs::app
