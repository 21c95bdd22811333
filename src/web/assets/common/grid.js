// The values of a range, as the service counts them (crates/job/src/grid.rs): both ends and the round values between
// them are met exactly.

/** Significant decimal digits up to which a value of a logarithmic grid counts as round. */
const ROUND_DIGITS = 12;
/** Whole numbers up to this are exact. */
const EXACT = 2 ** 53;
const SMALLEST_NORMAL = 2 ** -1022;

export function gridOf({ from, to, points, spacing }) {
  const last = points - 1;
  const linear = linearGrid(from, to, last);
  return Array.from({ length: points }, (_, index) => {
    if (index === 0) return from;
    if (index === last) return to;
    return spacing === "logarithmic" ? logarithmic(from, to, index / last) : linear(index);
  });
}

/**
 * With both ends as whole multiples of the same power of ten the value is a quotient of two whole numbers: rounded
 * once.
 */
function linearGrid(from, to, last) {
  const plain = (index) => from + (to - from) * (index / last);
  const ends = [decimal(from), decimal(to)];
  const exponent = Math.min(ends[0].exponent, ends[1].exponent);
  const [a, b] = ends.map(({ digits, exponent: own }) => digits * 10 ** (own - exponent));
  const divisor = last * 10 ** Math.max(-exponent, 0);
  const factor = 10 ** Math.max(exponent, 0);
  const largest = Math.max(Math.abs(a), Math.abs(b)) * last;
  if (largest > EXACT || divisor > EXACT || exponent > 15) return plain;
  return (index) => {
    const scaled = (a * (last - index) + b * index) * factor;
    return Math.abs(scaled) <= EXACT ? scaled / divisor : plain(index);
  };
}

/** A number as its shortest decimal digits, a whole number, and the power of ten they are multiples of. */
function decimal(value) {
  const [mantissa, exponent] = value.toExponential().split("e");
  const digits = Number(mantissa.replace(".", ""));
  return { digits, exponent: digits === 0 ? 0 : Number(exponent) - (mantissa.split(".")[1]?.length ?? 0) };
}

/** Equal ratios. A value within the rounding errors of the power of a round one is that one. */
function logarithmic(from, to, fraction) {
  const ratio = to / from;
  const isNormal = Number.isFinite(ratio) && ratio >= SMALLEST_NORMAL;
  const value = isNormal ? from * ratio ** fraction : from ** (1 - fraction) * to ** fraction;
  const size = isNormal ? Math.abs(Math.log(ratio)) : Math.abs(Math.log(from)) + Math.abs(Math.log(to));
  const round = Number(value.toPrecision(ROUND_DIGITS));
  return Math.abs(round - value) <= Number.EPSILON * (3 + size) * value ? round : value;
}
