// experiments/studies/distributed/traffic.h — messages, bytes and collective operations of this rank, counted where MPI
// is called: this program's MPI functions stand before MPI's own (its profiling interface), for PETSc and hypre too.
#pragma once

namespace orthant {

struct Traffic {
  long messages = 0;     // sent to one rank
  double bytes = 0;      // in them
  long collectives = 0;  // all-reductions, broadcasts, gathers, scans of more than one rank
};
Traffic traffic();  // since the start

/// Half the time of a message there and back between ranks 0 and 1 [s]; 0 on one rank. All ranks call it.
double time_of_message(int bytes, int repeats);
/// Time of an all-reduction of one number over all ranks [s].
double time_of_reduction(int repeats);

}  // namespace orthant
