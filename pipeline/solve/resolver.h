// Looks up what a scene names: media, depths, hosts, mirrors.
#pragma once

#include <limits>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// What the optics of a species depend on at a wavelength (ResolvedSpecies::key).
std::string species_key(const ResolvedSpecies& species, std::size_t w);

/// Looks up the parts of one scene.
class Resolver {
  public:
    /// @param example_wavelength_nm  a wavelength at which the scene is wanted, for advice
    /// @param memo     null: nothing is remembered
    /// @param shift    null: every index as it is known
    Resolver(const Scene& scene, double example_wavelength_nm, NamedIndexMemo* memo = nullptr,
             const IndexShift* shift = nullptr);

    /// @throws UsageError, InputError  as resolve() of resolved_scene.h
    /// @param optical_depth  of the layer, where nothing else tells how much there is of it
    ResolvedMedium medium(const Medium& medium, const std::vector<double>& wavelength_nm,
                          double optical_depth = std::numeric_limits<double>::infinity());
    /// The same as a half-space.
    ResolvedMedium base(const Medium& medium, const std::vector<double>& wavelength_nm);
    /// The rest of a layer without depth: its host, with no particles that need optics.
    ResolvedMedium host_alone(const Medium& medium, const std::vector<double>& wavelength_nm);
    ResolvedDepth depth(const Layer& layer, const ResolvedMedium& medium);
    /// n + ik of a species, of a mirror and (n alone) of a host at every wavelength.
    ResolvedIndex index(const Species& species, const std::vector<double>& wavelength_nm);
    ResolvedIndex mirror(const Host& of, const std::vector<double>& wavelength_nm);
    std::vector<double> real_index(const Host& host, const std::vector<double>& wavelength_nm);

    /// A source or note that is added twice is kept once.
    void add_note(std::string note) { add_once(notes_, std::move(note)); }
    void add_source(std::string source) { add_once(sources_, std::move(source)); }
    std::vector<std::string> take_sources() { return std::move(sources_); }
    std::vector<std::string> take_notes() { return std::move(notes_); }

  private:
    struct HostAt {
        std::string name = {};
        std::vector<std::complex<double>> index = {};
        std::optional<double> density_g_cm3 = {};
    };

    static void add_once(std::vector<std::string>& lines, std::string line);
    HostAt look_up(const Host& host, const std::vector<double>& wavelength_nm);
    static std::vector<Particles> particles(const ResolvedIndex& index,
                                            const std::vector<double>& wavelength_nm,
                                            const HostAt& host);
    /// @param spectrum_host  the host at spectrum_nm_
    ResolvedSpecies species(const Species& species, const std::vector<double>& wavelength_nm,
                            const HostAt& host, const HostAt& spectrum_host);
    std::vector<ResolvedIndex> coatings(const Species& species,
                                        const std::vector<double>& wavelength_nm);
    /// The host between the particles absorbs as a species of albedo 0 would (Mie theory itself
    /// takes the real part of the host's index).
    void set_host_absorption(const HostAt& host, const std::vector<double>& wavelength_nm,
                             double optical_depth, ResolvedMedium& medium);
    /// Without amounts nobody knows how much host there is; a weak one may be left out.
    /// @throws UsageError  when it could matter
    void leave_out_host(const HostAt& host, const std::vector<double>& wavelength_nm,
                        double optical_depth, const ResolvedMedium& medium);
    void note_strong_host(const HostAt& host, double k, double nm, const ResolvedMedium& medium);
    // crowded_medium.cpp
    void set_effective_host(ResolvedMedium& medium);
    void set_packing(ResolvedMedium& medium);
    void note_crowding(const ResolvedMedium& medium);
    static void require_particles(const Layer& layer);
    /// Refuses optical depths of a host alone that absorbs nothing.
    static void require_depth(const ResolvedMedium& medium);
    /// The medium of a layer at the wavelength of its depth.
    ResolvedMedium reference(const Layer& layer);

    const Scene& scene_;
    double example_wavelength_nm_;
    bool tells_crowding_;
    std::vector<double> spectrum_nm_;  ///< empty: those of the scene
    Materials materials_;
    std::vector<std::string> sources_, notes_;
};

/// Whether a scene lies on a mirror.
bool has_mirror(const Scene& scene);
/// Whether there is anything but air between particles.
bool has_host(const Host& host);

}  // namespace miebrdf
