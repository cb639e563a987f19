// Entries of the logbook that the screen MODEL writes; nothing where no logbook is kept.
#pragma once

#include "commissioning/models/work.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {

void log_saved_model(const ModelArguments& files, const model::Model& model);

/// @param model  as it was when the diagnosis began
void log_diagnosis(const ModelArguments& files, const model::Model& model, const model::Diagnosis& diagnosis);

}  // namespace ecs::commissioning
