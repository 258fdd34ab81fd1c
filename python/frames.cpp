#include "python/frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

/// How many frames are fetched before the tracking begins, and how many beyond the one that is
/// read.
constexpr std::int64_t kept_at_first = 10;
constexpr std::int64_t fetched_ahead = 3;

template <class T>
Image filled_from(const py::handle& source, const std::string& name) {
    const auto array = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(source);
    if (!array) throw py::error_already_set();
    Image image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
    const T* from = array.data();
    std::transform(from, from + image.size(), image.pixels().begin(),
                   [](T count) { return static_cast<float>(count); });
    if constexpr (std::is_floating_point_v<T>) {
        const auto is_wrong = [](float v) { return !std::isfinite(v); };
        if (std::ranges::any_of(image.pixels(), is_wrong)) {
            throw InputError({name + " is not usable", "a pixel that is not finite",
                              "finite counts", "replace NaN and infinite pixels, or mask them"});
        }
    }
    return image;
}

std::string shape_text(const py::array& array) {
    return py::str(array.attr("shape"));
}

py::array numpy_array(const py::handle& object, const std::string& name) {
    py::array array = py::array::ensure(object);
    if (!array) {
        PyErr_Clear();
        throw InputError({name + " is not an array", std::string(Py_TYPE(object.ptr())->tp_name),
                          "a 2D array of numbers", ""});
    }
    if (array.ndim() != 2 || array.size() == 0) {
        throw InputError({name + " is not one grey image", "shape " + shape_text(array),
                          "shape (height, width), not empty",
                          array.ndim() == 3
                              ? "take one channel or their mean; give a film to track "
                                "or batch"
                              : ""});
    }
    if (std::string("biuf").find(array.dtype().kind()) == std::string::npos) {
        throw InputError({name + " does not hold numbers", py::str(array.dtype()),
                          "uint8, uint16 or another real type", ""});
    }
    return array;
}

/// pims frames know which of the film they are.
std::int64_t index_of(const py::object& array, std::int64_t position) {
    const py::object number = py::getattr(array, "frame_no", py::none());
    if (number.is_none() || PyIndex_Check(number.ptr()) == 0) return position;
    return number.cast<std::int64_t>();
}

}  // namespace

int bit_depth_of(const py::handle& array) {
    const py::array held = py::array::ensure(array);
    return held && held.itemsize() == 1 ? 8 : 16;
}

Image image_of(const py::handle& object, const std::string& name) {
    const py::array array = numpy_array(object, name);
    const char kind = array.dtype().kind();
    if (array.itemsize() == 1 && kind != 'i') return filled_from<std::uint8_t>(array, name);
    if (array.itemsize() == 2 && kind == 'u') return filled_from<std::uint16_t>(array, name);
    if (array.itemsize() == 4 && kind == 'f') return filled_from<float>(array, name);
    return filled_from<double>(array, name);
}

Frame PythonFrames::frame_of(const py::object& array, std::int64_t position) {
    Frame frame;
    frame.index = position;
    if (array.is_none()) {
        frame.status = FrameStatus::missing;
        frame.message = "None stands for it";
    } else {
        const std::string name = fmt::format("frame {}", position);
        frame.index = index_of(array, position);
        frame.image = image_of(array, name);
        const bool is_first = width_ == 0;
        if (is_first) {
            width_ = frame.image.width();
            height_ = frame.image.height();
            bit_depth_ = bit_depth_of(array);
        } else if (frame.image.width() != width_ || frame.image.height() != height_) {
            throw InputError({name + " has another size",
                              fmt::format("{} x {} px", frame.image.width(), frame.image.height()),
                              fmt::format("{} x {} px, as the first", width_, height_), ""});
        }
    }
    frame.bit_depth = bit_depth_;
    frame.time = static_cast<double>(frame.index) / frame_rate_.value_or(1);
    return frame;
}

void PythonFrames::require_size() const {
    if (width_ > 0) return;
    throw InputError({"there is no frame", "none that is an image", "at least one 2D array", ""});
}

SequenceFrames::SequenceFrames(const py::object& frames, std::optional<double> frame_rate)
    : PythonFrames(frame_rate),
      frames_(frames),
      count_(static_cast<std::int64_t>(py::len(frames))) {
    for (std::int64_t i = 0; i < count_ && width() == 0; ++i) frame_of(frames[py::int_(i)], i);
    require_size();
}

Frame SequenceFrames::read(std::int64_t position) {
    const py::gil_scoped_acquire lock;
    return frame_of((*frames_)[py::int_(position)], position);
}

StreamedFrames::StreamedFrames(const py::iterator& frames, std::optional<double> frame_rate)
    : PythonFrames(frame_rate), frames_(frames) {
    fetch_until(kept_at_first);
    require_size();
}

void StreamedFrames::fetch_until(std::int64_t end) {
    while (!has_ended_ && fetched_ < end) {
        const auto array = py::reinterpret_steal<py::object>(PyIter_Next(frames_->ptr()));
        if (!array) {
            if (PyErr_Occurred() != nullptr) throw py::error_already_set();
            has_ended_ = true;
            return;
        }
        kept_.push_back(frame_of(array, fetched_));
        ++fetched_;
    }
}

Frame StreamedFrames::read(std::int64_t position) {
    const std::lock_guard guard(mutex_);
    {
        const py::gil_scoped_acquire lock;
        fetch_until(position + 1 + fetched_ahead);
    }
    std::int64_t first = fetched_ - static_cast<std::int64_t>(kept_.size());
    if (position < first || position >= fetched_) {
        throw InputError({fmt::format("frame {} of an iterator is not at hand", position),
                          fmt::format("frames {} to {} are", first, fetched_ - 1),
                          "frames in order", "give a list or an array"});
    }
    Frame frame = kept_[static_cast<std::size_t>(position - first)];
    for (; position > kept_at_first && first < position - 1; ++first) kept_.pop_front();
    return frame;
}

std::unique_ptr<FrameSource> frames_of(const py::object& frames, std::optional<double> frame_rate) {
    if (py::hasattr(frames, "__len__") && py::hasattr(frames, "__getitem__")) {
        return std::make_unique<SequenceFrames>(frames, frame_rate);
    }
    const auto iterator = py::reinterpret_steal<py::object>(PyObject_GetIter(frames.ptr()));
    if (!iterator) {
        PyErr_Clear();
        throw InputError(
            {"there are no frames to be had", std::string(Py_TYPE(frames.ptr())->tp_name),
             "a path, an array (frames, height, width), or what gives 2D arrays one by "
             "one",
             ""});
    }
    return std::make_unique<StreamedFrames>(py::reinterpret_borrow<py::iterator>(iterator),
                                            frame_rate);
}

}  // namespace grainfield::python
