#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/run_plan.h"
#include "core/vec3.h"
#include "simulate/render/projection.h"

namespace grainfield::simulate {

/// Spheres of diameter 1 between two plates, at one instant. Lengths in a.
struct SphereScene {
    std::vector<Vec3> centre;
    double low_plate = 0;  ///< height of its upper face
    double high_plate = 0;
};

/// What the images so far took.
struct OpticsCost {
    double pixels = 0;
    double settled = 0;       ///< pixels that were decided without tracing a ray
    double rays = 0;          ///< rays traced, reflected ones included; 0 where there are none
    double samples = 0;       ///< of these, rays that start in the camera
    double uniform_rays = 0;  ///< an estimate: with as many samples in every pixel
};

/// Forms images of spheres: each pixel is the mean, over its square, of the radiance relative to
/// the unobstructed backlight (1 bright, 0 black), in focus, and over the instants of an exposure.
/// Illumination, blur and noise are the camera's.
class Optics {
 public:
    virtual ~Optics() = default;

    /// `instants`: one or more, of the same spheres in the same order. Same scenes and view → same
    /// bits, for any number of threads. Spheres outside the view are allowed; those beside it may
    /// still reflect into it.
    virtual Image radiance(std::span<const SphereScene> instants, const View& view) = 0;
    Image radiance(const SphereScene& scene, const View& view) {
        return radiance({&scene, 1}, view);
    }
    virtual OpticsCost cost() const = 0;
};

/// One way to form images, with its options: what the program must know of it before it renders.
/// Adding one takes a pair of files with a class of this kind, and a line in optics_list.cpp.
class OpticsKind {
 public:
    virtual ~OpticsKind() = default;
    virtual std::unique_ptr<OpticsKind> copy() const = 0;
    /// Takes over the options of `other`, which is of the same kind.
    virtual void assign(const OpticsKind& other) = 0;

    virtual std::string name() const = 0;     ///< as a user chooses it
    virtual std::string meaning() const = 0;  ///< some words for the help
    virtual std::string title() const = 0;    ///< in the plan: "ray tracing"

    /// The options, in a section of that name.
    virtual OptionTable describe() = 0;
    /// Throws OptionError where fields are in range but do not go together.
    virtual void require_valid() const {}

    /// `noise`: variance of the noise of the camera's bright field / its square.
    virtual std::unique_ptr<Optics> make(double noise, int threads) const = 0;
    /// What is skipped, and why. `noise` as in make.
    virtual void explain(double /*noise*/, RunPlan& /*plan*/) const {}

    /// Whether images are sums over samples, which take seconds.
    virtual bool samples() const { return false; }
    /// Options that are left open become what `noise` asks for.
    virtual void settle(double /*noise*/) {}
    /// Gives up all savings that cost accuracy; false if there are none.
    virtual bool become_reference() { return false; }
};

/// What every kind shares. `Kind` derives from it and from the plain struct of its options.
template <class Kind>
class OpticsKindOf : public OpticsKind {
 public:
    std::unique_ptr<OpticsKind> copy() const override {
        return std::make_unique<Kind>(static_cast<const Kind&>(*this));
    }
    void assign(const OpticsKind& other) override {
        static_cast<Kind&>(*this) = dynamic_cast<const Kind&>(other);
    }
};

}  // namespace grainfield::simulate
