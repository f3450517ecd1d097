/*
 * The probability that the named effects are the ones that act.
 *
 * An effect outside the catalogue is taken in part by causes of the catalogue: six terms of a flux map, for example, take a fifth of an
 * angle's error of the third order, and each term is certain. The probabilities of the causes compare them with each other only. So the
 * share of the error that is left is weighed as well. All effects of the catalogue together leave little. An effect outside it can leave
 * any share:
 *
 *     left         share of the nominal model's error that is left, as power above the noise
 *     inside       left is exponential of mean 0.05
 *     outside      left is uniform from 0 to 1
 *     odds         ten drives of the catalogue for each one that is not
 *
 * The causes are named if the probability of the catalogue is at least 0.95. Then the share left is at most 0.12.
 */
#ifndef SIM_HOST_DIAGNOSE_WEIGH_BORNE_OUT_H
#define SIM_HOST_DIAGNOSE_WEIGH_BORNE_OUT_H

/*
 * The share left, 0 to 1, and more if the error rises; errors in one unit. Up to 1.25 noise floors an error counts as noise. A simulation
 * that diverged has an error of NAN. NAN if the nominal error is that small, as it says nothing about its parts, or if the nominal model
 * diverges. INFINITY if the extended model alone diverges.
 */
double borne_out_left(double nominal, double extended, double floor);

/* The probability of the catalogue, given the share that is left; of the one before all for NAN. */
double borne_out_probability(double left);

#endif
