"""Independent references for the engine: the papers' equations in plain NumPy and SciPy.

Nothing here imports the product. Each module states plant and observer once, as readable matrix equations with the
paper's numbers, and integrates them jointly, with SciPy's DOP853 at rtol 1e-11 restarted at every discontinuity, or
with a textbook RK4 at a fixed step. Results are dicts of arrays whose first axis is the record grid: t, u, signal,
theta, x, y, xhat, thetahat, ... For example zhao.rk4(), zhao.dop853(zhao.PENDULUM, zhao.pendulum_scenario(),
zhao.PENDULUM_GAINS). Noise is given as an array of held values, so a noisy run of another program is repeated by
handing over its own noise.

- `integration`: signals with left and right limits, `Scenario` (what happens in a run), `simulate`, DOP853 and RK4.
- `zhao`: Zhao, Li, Li 2012: plant (44), Contois (43) with its coordinate change, observer (34a-d) and the high-gain
  observer (9) for any n; `PENDULUM` (n = 3, two state faults, one sensor fault).
- `shen_hu`: Shen, Hu 2015: observer (11)-(12), its linear baselines, the matching condition (8); `CHAIN` (n = 3).
- `reduced_order`: reduced-order observer (17) and the full-order observer in the same normal form; the paper's
  plant and `CARTS` (n = 5, vector relative degree (3, 2), time-varying).
- `zhou_tan`: Zhou, Tan 2012: backlash operators (6)-(9), plant (11)-(12), observer (13), the conventional observer;
  `OTHER` (three operators, m1 != m2).
- `kalman`: adaptive Kalman observer in continuous and discrete time, joint EKF, joint UKF, for any `Model`.
- `tanks`, `motor`: models of the three-tank system DTS200, Johansson's quadruple tank, a DC motor with friction.
- `test_reference`, `test_reference_kalman`: these modules against the numbers known for the papers, each other,
  and theory.
"""
