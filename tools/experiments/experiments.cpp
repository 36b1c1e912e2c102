#include <array>

#include "tools/experiments/experiment.hpp"

namespace crspf::experiments {

std::span<const Experiment> experiments() {
    static constexpr const char* kBeyond = "beyond the paper";
    static constexpr std::array kAll{
        Experiment{"table1", "Map error in 1r5map and in an arena", "Table 1", 10, table1},
        Experiment{"rays", "Critical rays on scans", "Fig. 9", 0, rays},
        Experiment{"match", "Match value, thresholds and Result", "Fig. 11", 0, match},
        Experiment{"live", "The modules of the running service, and their load", "Figs. 13 and 14", 0, live},
        Experiment{"meeting", "Meeting room, 30 m x 10 m", "Fig. 15", 5, meeting},
        Experiment{"corridor", "Corridor of 80 m", "Fig. 16", 10, corridor},
        Experiment{"lobby", "Corridor with a big hall", "Fig. 17", 5, lobby},
        Experiment{"bank", "Bank hall with people", "Fig. 17", 5, bank},
        Experiment{"campus", "Campus, 2 km", "Fig. 19", 0, campus},
        Experiment{"parking", "Car park", "Fig. 19", 0, parking},
        Experiment{"ablation", "Each idea alone, and without it", "Sections 2 to 5", 20, ablation},
        Experiment{"logs", "Real logs", kBeyond, 5, logs},
        Experiment{"scale", "Growth with map, path, beams and particles", kBeyond, 0, scale},
    };
    return kAll;
}

}  // namespace crspf::experiments
