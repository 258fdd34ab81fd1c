#pragma once

#include "core/support/output_file.h"

namespace grainfield::io {

using grainfield::OutputFile;
using grainfield::Overwrite;

}  // namespace grainfield::io
