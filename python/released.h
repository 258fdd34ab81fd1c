#pragma once

#include <functional>
#include <memory>
#include <utility>

#include <pybind11/pybind11.h>

namespace grainfield::python {

/// Does `work` in a thread of its own, without the interpreter lock, and returns when it is done.
/// Throws what it threw. Call it with the lock held.
///
/// Meanwhile this thread looks for signals. When one raises in Python (Ctrl-C: KeyboardInterrupt),
/// the work is told to stop (StoppableJob) and has 1.5 s for it. Work whose unit takes longer is
/// left to finish that unit unseen, and its result is dropped: so `work` must own all that it uses.
/// Python threads other than the main one receive no signals; they wait.
void run_released(std::function<void()> work);

/// Waits for work that was left behind, or for another Ctrl-C; after that all work is done in the
/// calling thread. For the end of the interpreter.
void stop_workers();

/// A Python object that threads without the interpreter lock may copy and drop.
class SharedObject {
 public:
    explicit SharedObject(pybind11::object object)
        : object_(new pybind11::object(std::move(object)), [](pybind11::object* last) {
              const pybind11::gil_scoped_acquire lock;
              delete last;
          }) {}

    /// To be used with the lock held.
    const pybind11::object& operator*() const { return *object_; }
    const pybind11::object* operator->() const { return object_.get(); }

 private:
    std::shared_ptr<pybind11::object> object_;
};

}  // namespace grainfield::python
