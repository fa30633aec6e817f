// A small path tracer: a ball on the ground, both of white paint, in the light of a softbox and an
// even sky. The paint is solved once; its table is then evaluated and sampled at every reflection,
// and the softbox is sampled too (multiple importance sampling by the balance heuristic; Veach and
// Guibas 1995). The program writes path_tracer.pfm, and ball_on_ground.obj of the same scene for
// `miebrdf render`; its command is printed, and docs/rendering.md compares both pictures.
//
//     path_tracer [SAMPLES]
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/sampling.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

struct Vector {
    double x = 0, y = 0, z = 0;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator*(double s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
Vector operator-(Vector a, Vector b) { return a + -1.0 * b; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector unit(Vector a) { return (1 / std::sqrt(dot(a, a))) * a; }

using Colour = std::array<double, 3>;  // one value for each wavelength

// ---------------------------------------------------------------- Geometry

struct Hit {
    double distance;
    Vector normal;
};

constexpr double kGround = 2.0;        // half the side of the ground, a square at y = -1
constexpr double kObjectRadius = 3.0;  // of the sphere about ball and ground
constexpr double kNear = 1e-6;         // rays do not meet the place where they start

std::optional<Hit> intersect(Vector from, Vector along) {
    std::optional<Hit> hit;
    const double b = dot(from, along), root = b * b - dot(from, from) + 1.0;  // unit sphere
    if (root > 0.0) {
        const double far = -b + std::sqrt(root), close = -b - std::sqrt(root);
        const double t = close > kNear ? close : far;
        if (t > kNear) hit = Hit{t, from + t * along};
    }
    const double t = (-1.0 - from.y) / along.y;
    const Vector at = from + t * along;
    if (t > kNear && (!hit || t < hit->distance) && std::abs(at.x) < kGround &&
        std::abs(at.z) < kGround)
        hit = Hit{t, {0, along.y < 0 ? 1.0 : -1.0, 0}};
    return hit;
}

// ---------------------------------------------------------------- Light

// A square that faces the ball, as `miebrdf render --light area:40,-40,40,2.2` makes it, and the
// same radiance from everywhere (`uniform:0.3`).
struct Softbox {
    double half = std::tan(20 * kDegree), distance = 6 * kObjectRadius;
    Vector towards = {std::cos(40 * kDegree) * std::sin(-40 * kDegree), std::sin(40 * kDegree),
                      std::cos(40 * kDegree) * std::cos(-40 * kDegree)};
    Vector right = half * distance * unit(cross({0, 1, 0}, -1.0 * towards));
    Vector up = cross(right, towards);
    double radiance = [this] {
        const double s = half / std::sqrt(1 + half * half);
        return 2.2 / (4 * s * std::atan(s));  // irradiance over the square's form factor times pi
    }();

    Vector point(double u, double v) const {
        return distance * towards + (2 * u - 1) * right + (2 * v - 1) * up;
    }
    /// Density of `point` per unit of solid angle in a direction; 0 where the ray passes beside it.
    double density(Vector from, Vector along) const {
        const double cosine = dot(along, towards);
        if (!(cosine > 0.0)) return 0.0;  // its back is dark
        const double t = (distance - dot(from, towards)) / cosine;
        const double side = half * distance;
        const Vector in_plane = from + t * along;
        if (std::abs(dot(in_plane, right)) > side * side ||
            std::abs(dot(in_plane, up)) > side * side)
            return 0.0;
        return t * t / (4 * side * side * cosine);
    }
};
constexpr double kSky = 0.3;

// ---------------------------------------------------------------- Material

/// The paint seen from one direction. Paths start at the camera: what is drawn for the viewer is
/// where the light comes from, which a reciprocal BRDF allows.
class Paint {
  public:
    Paint(const miebrdf::BrdfTable& table, const miebrdf::DirectionSampler& sampler)
        : table_(table), sampler_(sampler) {}

    void look(Vector normal, Vector viewer) {
        normal_ = normal, viewer_ = viewer;
        mu_ = std::min(dot(normal, viewer), 1.0);
        const Vector sideways = viewer - mu_ * normal;
        // Azimuth 0 is the mirror side, opposite to the viewer.
        const bool straight = dot(sideways, sideways) < 1e-20;
        const Vector any = std::abs(normal.x) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0};
        mirror_ = straight ? unit(cross(normal, any)) : -1.0 * unit(sideways);
        across_ = cross(normal_, mirror_);
    }
    double cosine(Vector light) const { return dot(normal_, light); }
    /// f times the cosine of the light, which is above the surface.
    Colour reflected(Vector light) const {
        const miebrdf::Direction direction{std::min(cosine(light), 1.0), mu_, azimuth_deg(light)};
        Colour f;
        table_.evaluate({&direction, 1}, f);
        for (double& value : f) value *= direction.mu_in;
        return f;
    }
    double density(Vector light) const {
        return sampler_.density(mu_, std::min(cosine(light), 1.0), azimuth_deg(light));
    }
    Vector draw(double u1, double u2) const {
        const miebrdf::SampledDirection drawn = sampler_.sample(mu_, u1, u2);
        const double sine = std::sqrt(1 - drawn.mu_out * drawn.mu_out);
        const double azimuth = drawn.azimuth_deg * kDegree;
        return drawn.mu_out * normal_ + sine * std::cos(azimuth) * mirror_ +
               sine * std::sin(azimuth) * across_;
    }

  private:
    double azimuth_deg(Vector light) const {
        return std::atan2(dot(light, across_), dot(light, mirror_)) / kDegree;
    }
    const miebrdf::BrdfTable& table_;
    const miebrdf::DirectionSampler& sampler_;
    Vector normal_, viewer_, mirror_, across_;
    double mu_ = 1.0;
};

// ---------------------------------------------------------------- Paths

constexpr int kBounces = 4;  // as `miebrdf render` follows
constexpr double kHorizon = 1e-5;

template <typename Random>
Colour trace(Vector from, Vector along, Paint& paint, const Softbox& softbox, Random&& random) {
    Colour radiance = {}, throughput = {1, 1, 1};
    const auto add = [&](double amount, const Colour& factor) {
        for (int c = 0; c < 3; ++c) radiance[c] += amount * throughput[c] * factor[c];
    };
    double density = 0.0;  // of the last reflection's direction
    for (int reflections = 0;; ++reflections) {
        const std::optional<Hit> hit = intersect(from, along);
        if (!hit) {
            if (reflections == 0) return radiance;  // the camera sees neither sky nor softbox
            const double other = softbox.density(from, along);
            const double softly =
                other > 0.0 ? softbox.radiance * density / (density + other) : 0.0;
            add(kSky + softly, {1, 1, 1});
            return radiance;
        }
        if (reflections == kBounces || !(-dot(along, hit->normal) > kHorizon)) return radiance;
        from = from + hit->distance * along;
        paint.look(hit->normal, -1.0 * along);

        const Vector light = unit(softbox.point(random(), random()) - from);
        const double chosen = softbox.density(from, light);
        if (chosen > 0.0 && paint.cosine(light) > kHorizon && !intersect(from, light))
            add(softbox.radiance / (chosen + paint.density(light)), paint.reflected(light));

        along = paint.draw(random(), random());
        if (!(paint.cosine(along) > kHorizon)) return radiance;
        density = paint.density(along);
        const Colour reflected = paint.reflected(along);
        for (int c = 0; c < 3; ++c) throughput[c] *= reflected[c] / density;
    }
}

constexpr int kWidth = 96, kHeight = 72;

/// From the front, 20 degrees above the ground, so that the sphere about the object fits a field of
/// view of 25 degrees: the camera of `miebrdf render --camera 20,0 --zoom 1.5`.
std::vector<Colour> render(const miebrdf::BrdfTable& table,
                           const miebrdf::DirectionSampler& sampler, int samples,
                           unsigned threads) {
    const double half = std::tan(12.5 * kDegree) / 1.5;
    const Vector forward = {0, -std::sin(20 * kDegree), -std::cos(20 * kDegree)};
    const Vector eye = -kObjectRadius / std::sin(12.5 * kDegree) * forward;
    const Vector right = {half * kWidth / kHeight, 0, 0}, up = half * cross({1, 0, 0}, forward);
    const Softbox softbox;
    std::vector<Colour> picture(std::size_t(kWidth) * kHeight);
    std::atomic<int> next_row = 0;
    const auto work = [&] {
        Paint paint(table, sampler);
        for (int y = next_row++; y < kHeight; y = next_row++) {
            std::mt19937_64 bits(static_cast<unsigned>(y));  // the same picture by any threads
            const auto random = [&] { return double(bits() >> 11) * 0x1p-53; };
            for (int x = 0; x < kWidth; ++x) {
                Colour& pixel = picture[std::size_t(y) * kWidth + std::size_t(x)];
                for (int s = 0; s < samples; ++s) {
                    const double u = 2 * (x + random()) / kWidth - 1;
                    const double v = 1 - 2 * (y + random()) / kHeight;
                    const Vector along = unit(forward + u * right + v * up);
                    const Colour one = trace(eye, along, paint, softbox, random);
                    for (int c = 0; c < 3; ++c) pixel[c] += one[c] / samples;
                }
            }
        }
    };
    std::vector<std::thread> team(threads);
    for (std::thread& thread : team) thread = std::thread(work);
    for (std::thread& thread : team) thread.join();
    return picture;
}

// ---------------------------------------------------------------- Files

void write_pfm(const std::vector<Colour>& picture) {
    std::ofstream file("path_tracer.pfm", std::ios::binary);
    file << "PF\n" << kWidth << ' ' << kHeight << "\n-1.0\n";
    for (int y = kHeight - 1; y >= 0; --y) {  // from the bottom up
        for (int x = 0; x < kWidth; ++x) {
            for (const double value : picture[std::size_t(y) * kWidth + std::size_t(x)]) {
                const auto single = static_cast<float>(value);
                file.write(reinterpret_cast<const char*>(&single), sizeof single);
            }
        }
    }
}

void write_obj() {
    constexpr int kTurns = 192, kRings = 96;
    std::ofstream file("ball_on_ground.obj");
    file << "v -2 -1 -2\nv 2 -1 -2\nv 2 -1 2\nv -2 -1 2\nvn 0 1 0\nf 4//1 3//1 2//1 1//1\n";
    const auto vertex = [](int ring, int turn) { return 5 + ring * kTurns + turn % kTurns; };
    const auto corner = [&](int ring, int turn) {
        return std::to_string(vertex(ring, turn)) + "//" + std::to_string(vertex(ring, turn) - 3);
    };
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int turn = 0; turn < kTurns; ++turn) {
            const double a = kPi * ring / kRings, b = 2 * kPi * turn / kTurns;
            const Vector n = {std::sin(a) * std::sin(b), std::cos(a), std::sin(a) * std::cos(b)};
            for (const char* what : {"v ", "vn "})
                file << what << n.x << ' ' << n.y << ' ' << n.z << '\n';
            if (ring == kRings) continue;
            file << "f " << corner(ring, turn) << ' ' << corner(ring + 1, turn) << ' '
                 << corner(ring + 1, turn + 1) << ' ' << corner(ring, turn + 1) << '\n';
        }
    }
}

double lap_s() {
    static auto last = std::chrono::steady_clock::now();
    const auto before = std::exchange(last, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(last - before).count();
}

}  // namespace

int main(int count, char** arguments) try {
    const int samples = count > 1 ? std::max(1, std::atoi(arguments[1])) : 8;
    lap_s();
    miebrdf::Scene scene;
    scene.base = miebrdf::medium("TiO2,radius=0.13,volume=15% in index:1.5");
    scene.boundary = miebrdf::boundary("rough:0.3");
    const miebrdf::BrdfTable table = miebrdf::solve(scene, {620, 535, 480}, {.stokes = 1}).table();
    const double solved_s = lap_s();
    const miebrdf::DirectionSampler sampler(table);
    const double tabulated_s = lap_s();
    const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
    const std::vector<Colour> picture = render(table, sampler, samples, threads);
    const double traced_s = lap_s();
    write_pfm(picture);
    write_obj();
    std::cout << "solved in " << solved_s << " s, directions tabulated in " << tabulated_s << " s, "
              << kWidth * kHeight * samples << " paths in " << traced_s << " s by " << threads
              << " threads\nThe same by the program:\nmiebrdf render --object ball_on_ground.obj "
                 "--base 'TiO2,radius=0.13,volume=15% in index:1.5' --boundary rough:0.3 "
                 "--stokes 1 --wavelengths rgb --light area:40,-40,40,2.2 --light uniform:0.3 "
                 "--light-spectrum "
                 "white --camera 20,0 --zoom 1.5 --size 96,72 --exr render.exr\n";
    return table.report().converged() ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
