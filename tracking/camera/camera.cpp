#include "tracking/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/image_mat.h"

namespace grainfield::tracking {
namespace {

using Jacobian = CameraMap::Jacobian;

constexpr double kAccuracy = 1e-10;  // px
constexpr int kIterations = 50;
constexpr int kChecked = 32;           // steps along a side
constexpr double kLargestChange = 25;  // of areas
constexpr double kSeen = 1;            // px beside the frame that count as seen

struct Mapped {
    Vec2 place;
    Jacobian jacobian;
};

/// The formula of Lens.
Mapped distorted(const Lens& lens, Vec2 x) {
    const double r2 = squared_norm(x);
    const double radial = 1 + r2 * (lens.k1 + r2 * lens.k2);
    const double slope = lens.k1 + 2 * r2 * lens.k2;  // d radial / d r²
    const double xy = x.x * x.y;
    Mapped to;
    to.place = {x.x * radial + 2 * lens.p1 * xy + lens.p2 * (r2 + 2 * x.x * x.x),
                x.y * radial + lens.p1 * (r2 + 2 * x.y * x.y) + 2 * lens.p2 * xy};
    const double mixed = 2 * xy * slope + 2 * lens.p1 * x.x + 2 * lens.p2 * x.y;
    to.jacobian = {radial + 2 * x.x * x.x * slope + 2 * lens.p1 * x.y + 6 * lens.p2 * x.x, mixed,
                   mixed, radial + 2 * x.y * x.y * slope + 6 * lens.p1 * x.y + 2 * lens.p2 * x.x};
    return to;
}

Vec2 solved(const Jacobian& j, Vec2 d) {
    const double determinant = j.determinant();
    return {(j.yy * d.x - j.xy * d.y) / determinant, (j.xx * d.y - j.yx * d.x) / determinant};
}

/// The x whose image is `wanted`, and the Jacobian of the distortion there. NaN: not found on the
/// sheet that holds the centre.
Mapped undistorted(const Lens& lens, Vec2 wanted) {
    Mapped found{wanted, {}};
    if (lens.is_straight()) return found;
    for (int i = 0; i < kIterations; ++i) {
        const Mapped seen = distorted(lens, found.place);
        if (!(seen.jacobian.determinant() > 0)) break;
        const Vec2 step = solved(seen.jacobian, wanted - seen.place);
        found.place += step;
        if (norm(step) * lens.focal < kAccuracy) {
            found.jacobian = distorted(lens, found.place).jacobian;
            if (found.jacobian.determinant() > 0) return found;
            break;
        }
    }
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    return {{nothing, nothing}, {}};
}

Mapped projected(const std::array<double, 9>& h, Vec2 p) {
    const double w = h[6] * p.x + h[7] * p.y + h[8];
    const Vec2 to{(h[0] * p.x + h[1] * p.y + h[2]) / w, (h[3] * p.x + h[4] * p.y + h[5]) / w};
    return {to,
            {(h[0] - to.x * h[6]) / w, (h[1] - to.x * h[7]) / w, (h[3] - to.y * h[6]) / w,
             (h[4] - to.y * h[7]) / w}};
}

Jacobian product(const Jacobian& a, const Jacobian& b) {
    return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
            a.yx * b.xy + a.yy * b.yy};
}

Jacobian inverse(const Jacobian& j) {
    const double determinant = j.determinant();
    return {j.yy / determinant, -j.xy / determinant, -j.yx / determinant, j.xx / determinant};
}

std::array<double, 9> inverse(const std::array<double, 9>& m) {
    const std::array<double, 9> cofactors{
        m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
        m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
        m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    const double determinant = m[0] * cofactors[0] + m[1] * cofactors[3] + m[2] * cofactors[6];
    std::array<double, 9> result{};
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = cofactors[i] / determinant;
    return result;
}

/// A side of a frame from corner to corner, in steps of a pixel at most.
template <class Visit>
void along(Vec2 from, Vec2 to, const Visit& visit) {
    const int steps = std::max(1, static_cast<int>(std::ceil(norm(to - from))));
    for (int i = 0; i <= steps; ++i) {
        visit(from + (static_cast<double>(i) / steps) * (to - from));
    }
}

Box between(Vec2 low, Vec2 high) {
    Box box;
    box.origin = low;
    box.length = high - low;
    return box;
}

}  // namespace

void Camera::require_size(int other_width, int other_height, const std::string& film) const {
    if (other_width == width && other_height == height) return;
    throw InputError({.problem = "the camera was calibrated on frames of another size",
                      .actual = fmt::format("'{}' has {} x {} px", film, other_width, other_height),
                      .expected = fmt::format("{} x {} px, as calibrated", width, height),
                      .suggestion = "calibrate it on pictures of the size of the film"});
}

std::optional<double> Camera::diameter_px(const std::optional<double>& sphere_mm) const {
    if (!scale) return std::nullopt;
    if (scale->unit == PlaneUnit::diameter) return 1 / scale->length;
    if (!sphere_mm) return std::nullopt;
    return *sphere_mm / scale->length;
}

std::string fault_of(const Camera& camera) {
    if (camera.width < 1 || camera.height < 1) return "it has no frame";
    if (!(camera.lens.focal > 0)) return "the focal length is not positive";
    for (int j = 0; j <= kChecked; ++j) {
        for (int i = 0; i <= kChecked; ++i) {
            const Vec2 p{static_cast<double>(i) / kChecked * camera.width - 0.5,
                         static_cast<double>(j) / kChecked * camera.height - 0.5};
            const CameraMap::Corrected to = CameraMap::unchecked(camera, p);
            const double change = to.jacobian.determinant();
            if (!is_finite(to.position) || !(change > 1 / kLargestChange) ||
                !(change < kLargestChange)) {
                return fmt::format("it folds or stretches the picture at ({:.0f}, {:.0f}) px", p.x,
                                   p.y);
            }
        }
    }
    return {};
}

CameraMap::CameraMap(const Camera& camera, Vec2 origin)
    : camera_(camera), back_(inverse(camera.homography)), origin_(origin) {
    if (const std::string fault = fault_of(camera); !fault.empty()) {
        throw InputError({.problem = "positions cannot be corrected with this camera",
                          .actual = fault,
                          .expected = "a map that is one to one over the whole frame",
                          .suggestion = "calibrate it again"});
    }
}

CameraMap::Corrected CameraMap::unchecked(const Camera& camera, Vec2 p) {
    const Lens& lens = camera.lens;
    const Mapped ideal = undistorted(lens, (1 / lens.focal) * (p - lens.centre));
    const Mapped plane = projected(camera.homography, lens.focal * ideal.place + lens.centre);
    return {plane.place, product(plane.jacobian, inverse(ideal.jacobian))};
}

CameraMap::Corrected CameraMap::corrected(Vec2 p) const {
    Corrected result = unchecked(camera_, p + origin_);
    result.position -= origin_;
    return result;
}

Vec2 CameraMap::in_picture(Vec2 corrected) const {
    const Lens& lens = camera_.lens;
    const Vec2 ideal = projected(back_, corrected + origin_).place;
    const Vec2 seen = distorted(lens, (1 / lens.focal) * (ideal - lens.centre)).place;
    return lens.focal * seen + lens.centre - origin_;
}

void CameraMap::correct(Snapshot& snapshot) const {
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const auto [position, j] = corrected(snapshot.position[i]);
        snapshot.position[i] = position;
        if (snapshot.position_error.empty()) continue;
        Vec2& error = snapshot.position_error[i];
        error = {std::hypot(j.xx * error.x, j.xy * error.y),
                 std::hypot(j.yx * error.x, j.yy * error.y)};
    }
}

Box CameraMap::box(int width, int height) const {
    const Vec2 first{-0.5, -0.5};
    const Vec2 last{width - 0.5, height - 0.5};
    constexpr double far = std::numeric_limits<double>::infinity();
    Vec2 low{-far, -far};
    Vec2 high{far, far};
    along(first, {first.x, last.y},
          [&](Vec2 p) { low.x = std::max(low.x, corrected(p).position.x); });
    along(first, {last.x, first.y},
          [&](Vec2 p) { low.y = std::max(low.y, corrected(p).position.y); });
    along({last.x, first.y}, last,
          [&](Vec2 p) { high.x = std::min(high.x, corrected(p).position.x); });
    along({first.x, last.y}, last,
          [&](Vec2 p) { high.y = std::min(high.y, corrected(p).position.y); });
    if (camera_.cell) {
        const Vec2 begin = camera_.cell->origin - origin_;
        const Vec2 end = begin + camera_.cell->length;
        bool is_seen = true;
        const auto look = [&](Vec2 corrected) {
            const Vec2 p = in_picture(corrected);
            is_seen = is_seen && p.x > first.x - kSeen && p.y > first.y - kSeen &&
                      p.x < last.x + kSeen && p.y < last.y + kSeen;
        };
        along(begin, {begin.x, end.y}, look);
        along(begin, {end.x, begin.y}, look);
        along({end.x, begin.y}, end, look);
        along({begin.x, end.y}, end, look);
        if (is_seen) return between(begin, end);
        low = {std::max(low.x, begin.x), std::max(low.y, begin.y)};
        high = {std::min(high.x, end.x), std::min(high.y, end.y)};
    }
    if (!(high.x > low.x && high.y > low.y)) {
        throw InputError({.problem = "the camera leaves no rectangle of which all was seen",
                          .actual = fmt::format("the frame, {} x {} px, is turned or outside of "
                                                "the cell",
                                                width, height),
                          .expected = "a frame whose sides are roughly along those of the cell",
                          .suggestion = "turn the camera, or track another region"});
    }
    return between(low, high);
}

CorrectedPictures::CorrectedPictures(const CameraMap& map, int width, int height)
    : x_(width, height), y_(width, height) {
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            const Vec2 p = map.in_picture({static_cast<double>(column), static_cast<double>(row)});
            x_(column, row) = static_cast<float>(p.x);
            y_(column, row) = static_cast<float>(p.y);
        }
    }
}

Image CorrectedPictures::operator()(const Image& frame) const {
    if (frame.empty()) return {};
    cv::Mat seen;
    cv::remap(as_mat(frame), seen, as_mat(x_), as_mat(y_), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return from_mat(seen);
}

std::vector<double> numbers_of(const Camera& camera) {
    const Lens& lens = camera.lens;
    std::vector<double> numbers{static_cast<double>(camera.width),
                                static_cast<double>(camera.height),
                                lens.focal,
                                lens.centre.x,
                                lens.centre.y,
                                lens.k1,
                                lens.k2,
                                lens.p1,
                                lens.p2};
    numbers.insert(numbers.end(), camera.homography.begin(), camera.homography.end());
    const PlaneScale scale = camera.scale.value_or(PlaneScale{0, PlaneUnit::mm});
    numbers.push_back(scale.length);
    numbers.push_back(static_cast<double>(scale.unit));
    const Box cell = camera.cell.value_or(Box{});
    numbers.insert(numbers.end(), {cell.origin.x, cell.origin.y, cell.length.x, cell.length.y});
    return numbers;
}

}  // namespace grainfield::tracking
