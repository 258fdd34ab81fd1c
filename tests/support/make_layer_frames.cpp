// make-layer-frames OUTDIR [--frames N] [--size PX] [--diameter PX] [--seed N]
//
// Writes frame_0000.tif … and truth.csv of a square bilayer patch in a liquid: the stand-in for a
// camera until the renderer of simulate/ exists.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tiffio.h>

#include "tests/support/layer_frames.h"

namespace {

using namespace grainfield;

struct Request {
    std::filesystem::path folder;
    int frames = 40;
    int size = 640;
    double diameter = 12;
    std::uint64_t seed = 1;
    bool wants_help = false;
};

constexpr const char* kUsage =
    "usage: make-layer-frames OUTDIR [--frames N] [--size PX] [--diameter PX] [--seed N]\n"
    "  OUTDIR      folder for frame_0000.tif … and truth.csv\n"
    "  --frames    number of frames (default 40)\n"
    "  --size      width and height of a frame [px] (default 640, 64 at least)\n"
    "  --diameter  of a sphere [px] (default 12, 4 at least)\n"
    "  --seed      of places, steps and noise (default 1)\n";

Request parse(int argc, char** argv) {
    Request request;
    if (argc == 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
        request.wants_help = true;
        return request;
    }
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word.rfind("--", 0) != 0) {
            request.folder = word;
            continue;
        }
        if (i + 1 >= argc) throw std::invalid_argument(word + " needs a value");
        const std::string value = argv[++i];
        if (word == "--frames")
            request.frames = std::stoi(value);
        else if (word == "--size")
            request.size = std::stoi(value);
        else if (word == "--diameter")
            request.diameter = std::stod(value);
        else if (word == "--seed")
            request.seed = std::stoull(value);
        else
            throw std::invalid_argument("unknown option " + word);
    }
    if (request.folder.empty() || request.frames < 1 || request.size < 64 || request.diameter < 4) {
        throw std::invalid_argument(std::string("a folder, or a value, is missing or too small\n") +
                                    kUsage);
    }
    return request;
}

void write_tiff(const std::filesystem::path& path, const Image& image) {
    TIFF* tiff = TIFFOpen(path.c_str(), "w");
    if (tiff == nullptr) throw std::runtime_error("cannot write " + path.string());
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width());
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height());
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, image.height());
    std::vector<unsigned char> row(static_cast<std::size_t>(image.width()));
    bool written = true;
    for (int y = 0; y < image.height() && written; ++y) {
        for (int x = 0; x < image.width(); ++x) {
            row[static_cast<std::size_t>(x)] = static_cast<unsigned char>(image(x, y));
        }
        written = TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0) == 1;
    }
    TIFFClose(tiff);
    if (!written) throw std::runtime_error("cannot write " + path.string());
}

void make_frames(const Request& request) {
    std::filesystem::create_directories(request.folder);
    testing::CrystalPatch patch;
    patch.radius = 0.26;
    const double liquid_fraction = 0.70;  // of discs of the true diameter
    const testing::LayerScene start = testing::crystal_in_liquid(
        request.size, request.size, request.diameter, liquid_fraction, patch, request.seed);
    testing::LayerMotion motion(start, patch, 0.06 * request.diameter, request.seed);
    std::ofstream truth(request.folder / "truth.csv");
    truth << "frame,particle,x,y,layer\n";
    for (int f = 0; f < request.frames; ++f) {
        const testing::LayerScene& scene = motion.scene();
        const Image frame =
            testing::camera_frame(scene, {}, request.seed + static_cast<unsigned>(f));
        write_tiff(request.folder / fmt::format("frame_{:04}.tif", f), frame);
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            truth << fmt::format("{},{},{:.6f},{:.6f},", f, i, scene.position[i].x,
                                 scene.position[i].y);
            if (scene.layer[i] != Layer::unknown) truth << static_cast<int>(scene.layer[i]);
            truth << '\n';
        }
        motion.advance();
    }
    if (!truth.flush()) throw std::runtime_error("cannot write truth.csv");
    std::cout << fmt::format("{} frames of {} spheres in {}\n", request.frames,
                             start.position.size(), request.folder.string());
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Request request = parse(argc, argv);
        if (request.wants_help) {
            std::cout << kUsage;
        } else {
            make_frames(request);
        }
    } catch (const std::exception& error) {
        std::cerr << "make-layer-frames: " << error.what() << '\n';
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
