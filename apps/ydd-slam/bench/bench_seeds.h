// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/figures.h"
#include "ydd/studies/simulated_run.h"

namespace ydd::app {

/// What the benches on simulated worlds have in common. Seeds of the vocabulary's training
/// pictures are below 100.
struct SeedRequest {
  std::vector<std::string> sequences;  ///< recordings to add (places)
  int seeds = 20;
  int first_seed = 101;
  int width_px = 320;  ///< 4:3
  double fps = 10;
  double minutes = 30;          ///< of the walk
  double apart_s = 6;           ///< between two looks at a place (places)
  std::string only;             ///< worlds or accidents whose name has this in it; empty: all
  std::string senses = "none";  ///< of motion, besides the camera (recovery)
  std::string out;              ///< JSON file; empty: none
  std::vector<std::string> set;
};

/// A walk round the rooms with this seed, at the request's size and rate.
WorldOptions walk_world(const SeedRequest& request, int seed, int rooms = 1);

/// Whether `name` is asked for.
bool is_wanted(const SeedRequest& request, const std::string& name);

/// Loops closed, false ones, and the trajectory error with and without, over seeds and worlds:
/// one room, two rooms, and rooms that look alike.
Result<std::string> bench_loops(const SeedRequest& request);

/// How often a place is recognised, by similarity alone and verified, over seeds.
Result<std::string> bench_places(const SeedRequest& request);

/// How often and how soon a lost camera is found again: covered, kidnapped, turned away, crowded.
Result<std::string> bench_recovery(const SeedRequest& request);

/// A long walk through several rooms: time per frame, memory and map size as it goes on.
Result<std::string> bench_walk(const SeedRequest& request);

/// How soon a mover is found by what the last frames show, over its speed and distance, and how
/// often something in a rigid room is taken for one.
Result<std::string> bench_motion(const SeedRequest& request);

/// People in the map's frame against the truth: place, velocity, mistaken identities.
Result<std::string> bench_tracks(const SeedRequest& request);

}  // namespace ydd::app
