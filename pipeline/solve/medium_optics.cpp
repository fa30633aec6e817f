// Media: their species, each different one computed once, and what they are together.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/packing.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/sampled_spectrum.h"
#include "pipeline/solve/single_scattering.h"
#include "pipeline/solve/size_lattice.h"

namespace miebrdf {
namespace {

/// Species at a wavelength.
struct Job {
    const ResolvedSpecies* species;
    std::size_t wavelength;
};

/// Jobs, each once, found by what they depend on.
class JobList {
  public:
    /// The number of the job.
    std::size_t add(const ResolvedSpecies& species, std::size_t w) {
        const std::string name =
            species.crowded ? species.key[w] + crowd_key(species, w) : species.key[w];
        const auto [found, is_new] = known_.try_emplace(name, jobs_.size());
        if (is_new) jobs_.push_back({&species, w});
        return found->second;
    }

    std::vector<std::size_t> add(const ResolvedMedium& medium, std::size_t w) {
        std::vector<std::size_t> all;
        for (const ResolvedSpecies& species : medium.species) all.push_back(add(species, w));
        return all;
    }

    /// The results, job by job.
    std::vector<MediumOptics> compute(const OpticsDemand& of_all, const Control& control) const {
        std::vector<MediumOptics> done(jobs_.size());
        const mie::Executor pieces = pieces_of_job(control);
        // All threads sample one spectrum after the other.
        std::set<const ResolvedSpecies*> sampled;
        for (const auto [species, w] : jobs_) {
            const OpticsDemand demand = crowd_demand(*species, of_all);
            const OpticsDemand averaged = demand_of_average(species->species, demand);
            if (is_sampled(control, *species, averaged) && sampled.insert(species).second)
                species_optics(control, *species, w, demand, pieces);
        }
        run_parallel("single scattering", jobs_.size(), control, [&](std::size_t j) {
            const auto [species, w] = jobs_[j];
            const OpticsDemand demand = crowd_demand(*species, of_all);
            done[j] = species->needs_mie() ? species_optics(control, *species, w, demand, pieces)
                                           : compute_optics(*species, w, demand, pieces);
            if (species->crowded) done[j] = crowded(done[j], *species, w, demand.angles_deg);
        });
        return done;
    }

  private:
    std::map<std::string, std::size_t> known_;
    std::vector<Job> jobs_;
};

std::vector<MediumOptics> chosen(const std::vector<MediumOptics>& all,
                                 const std::vector<std::size_t>& which) {
    std::vector<MediumOptics> some;
    some.reserve(which.size());
    for (const std::size_t i : which) some.push_back(all[i]);
    return some;
}

/// Matter of albedo 0.
MediumOptics absorber() {
    MediumOptics optics;
    optics.optics.single_scattering_albedo = 0.0;
    optics.optics.one_minus_albedo = 1.0;
    return optics;
}

/// 3 f Q_ext / (4 r_eff): of the cores, as Q_ext is, which fill f / volume_per_core.
double extinction_of(const ResolvedSpecies& species, const MediumOptics& optics) {
    return 0.75 * species.volume_fraction * optics.q_ext.value_or(0.0) /
           (species.effective_radius_um * species.volume_per_core);
}

}  // namespace

OpticsDemand crowd_demand(const ResolvedSpecies& species, OpticsDemand demand) {
    demand.whole_phase_function = demand.whole_phase_function || species.crowded;
    return demand;
}

double extinction_per_um(const ResolvedMedium& medium, std::size_t w,
                         const std::vector<MediumOptics>& species) {
    if (!medium.has_extinction()) return 0.0;
    double sum = medium.host_absorption[w];
    for (std::size_t s = 0; s < species.size(); ++s)
        sum += extinction_of(medium.species[s], species[s]);
    return sum;
}

MediumOptics mixed(const ResolvedMedium& medium, std::size_t w,
                   const std::vector<MediumOptics>& species) {
    const double host = medium.host_absorption[w];
    MediumOptics whole = species.front();
    whole.extinction_per_um = extinction_per_um(medium, w, species);
    if (species.size() == 1 && host == 0.0) return whole;  // one species: no mixing
    std::vector<rte::MixtureComponent> components;
    std::vector<double> scattering;
    double sum = 0.0;
    for (std::size_t s = 0; s < species.size(); ++s) {
        const double extinction = extinction_of(medium.species[s], species[s]);
        components.push_back({species[s].optics, extinction});
        scattering.push_back(extinction * species[s].optics.single_scattering_albedo);
        sum += scattering.back();
        whole.error_estimate = std::max(whole.error_estimate, species[s].error_estimate);
        whole.converged = whole.converged && species[s].converged;
    }
    if (host > 0.0) components.push_back({absorber().optics, host});
    whole.optics = rte::mix(components);
    whole.q_ext.reset();
    whole.asymmetry = 0.0;
    std::fill(whole.phase.begin(), whole.phase.end(), 0.0);
    std::fill(whole.phase_error.begin(), whole.phase_error.end(), 0.0);
    for (std::size_t s = 0; s < species.size() && sum > 0.0; ++s) {
        const double share = scattering[s] / sum;
        whole.asymmetry += share * species[s].asymmetry;
        for (std::size_t a = 0; a < whole.phase.size(); ++a)
            whole.phase[a] += share * species[s].phase[a];
        for (std::size_t a = 0; a < species[s].phase_error.size(); ++a)
            whole.phase_error[a] += share * species[s].phase_error[a];
    }
    return whole;
}

MediumOptics compute_optics(const ResolvedScene& scene, std::size_t medium, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run) {
    const ResolvedMedium& resolved = scene.media[medium];
    std::vector<MediumOptics> species;
    for (const ResolvedSpecies& one : resolved.species) {
        const OpticsDemand of_species = crowd_demand(one, demand);
        species.push_back(compute_optics(one, w, of_species, run));
        if (one.crowded) species.back() = crowded(species.back(), one, w, demand.angles_deg);
    }
    return mixed(resolved, w, species);
}

std::vector<std::vector<MediumOptics>> optics_of(const ResolvedScene& scene,
                                                 const std::vector<std::size_t>& media,
                                                 const std::vector<std::size_t>& wavelengths,
                                                 const OpticsDemand& demand,
                                                 const Control& control) {
    JobList list;
    std::vector<std::vector<std::size_t>> jobs;  // [wavelength and medium][species]
    for (const std::size_t w : wavelengths) {
        for (const std::size_t m : media) jobs.push_back(list.add(scene.media[m], w));
    }
    const std::vector<MediumOptics> done = list.compute(demand, control);
    std::vector<std::vector<MediumOptics>> all;
    auto next = jobs.begin();
    for (const std::size_t w : wavelengths) {
        auto& row = all.emplace_back();
        for (const std::size_t m : media)
            row.push_back(mixed(scene.media[m], w, chosen(done, *next++)));
    }
    return all;
}

std::vector<std::vector<double>> optical_depths_of(const ResolvedScene& scene,
                                                   const std::vector<std::size_t>& wavelengths,
                                                   double mie_tolerance, const Control& control) {
    OpticsDemand demand;
    demand.tolerance = mie_tolerance;
    struct Following {
        std::size_t place, layer;
        std::vector<std::size_t> here, reference;
    };
    JobList list;
    std::vector<Following> following;
    std::vector<std::vector<double>> depths(wavelengths.size());
    for (std::size_t place = 0; place < wavelengths.size(); ++place) {
        const std::size_t w = wavelengths[place];
        for (std::size_t layer = 0; layer < scene.layers(); ++layer) {
            const ResolvedDepth& depth = scene.depths[layer];
            depths[place].push_back(depth.optical_depth);
            const bool is_there =
                depth.reference && depth.depth.wavelength_nm == scene.wavelength_nm[w];
            if (depth.is_grey() || is_there) continue;
            following.push_back({place, layer, list.add(scene.media[layer + 1], w), {}});
            if (depth.reference) following.back().reference = list.add(*depth.reference, 0);
        }
    }
    const std::vector<MediumOptics> done = list.compute(demand, control);
    for (const Following& f : following) {
        const ResolvedDepth& depth = scene.depths[f.layer];
        const double here =
            extinction_per_um(scene.media[f.layer + 1], wavelengths[f.place], chosen(done, f.here));
        depths[f.place][f.layer] =
            depth.column_um ? *depth.column_um * here
                            : depth.optical_depth * here /
                                  extinction_per_um(*depth.reference, 0, chosen(done, f.reference));
    }
    return depths;
}

}  // namespace miebrdf
