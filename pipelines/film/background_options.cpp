#include "pipelines/film/background_options.h"

#include "core/errors.h"

namespace grainfield::pipelines {

void set_source(BackgroundOptions& options, const std::string& text) {
    if (text.empty()) {
        throw OptionError({.problem = "option 'background' has no value",
                           .actual = {},
                           .expected = "none, static, running, or the name of a picture",
                           .suggestion = {}});
    }
    options.picture.clear();
    if (text == "none") {
        options.source = BackgroundSource::smooth;
    } else if (text == "static") {
        options.source = BackgroundSource::film;
    } else if (text == "running") {
        options.source = BackgroundSource::running;
    } else {
        options.source = BackgroundSource::picture;
        options.picture = text;
    }
}

}  // namespace grainfield::pipelines
