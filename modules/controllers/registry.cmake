# The controls that are there: each source <id>_format.cpp of FOLDER defines the ControllerFormat <id>_format. Their ids go into
# `controls`, their registry into the source REGISTRY. Also alone: cmake -DFOLDER=... -DREGISTRY=... -P registry.cmake
file(GLOB controls ${FOLDER}/*_format.cpp)
list(TRANSFORM controls REPLACE ".*/(.*)_format.cpp" "\\1")
list(JOIN controls "_format, " named)
list(JOIN controls "_format, &" listed)
file(CONFIGURE OUTPUT ${REGISTRY} CONTENT [[#include "modules/controllers/format.hpp"

namespace ecs::controllers {
extern const ControllerFormat @named@_format;
std::vector<const ControllerFormat*> formats_there() { return {&@listed@_format}; }
}  // namespace ecs::controllers
]] @ONLY)
