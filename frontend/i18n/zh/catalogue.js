// What the catalogue says of observers, gains and faults, in Chinese.

export const catalogue = {
  'Estimates the state of a uniformly observable single-output plant; knows of no faults.':
    '估计一致可观的单输出对象的状态；不考虑故障。',
  'Estimates state, actuator and sensor faults of a single-output plant that has a canonical form.':
    '估计具有规范型的单输出对象的状态、执行器故障和传感器故障。',
  'Estimates the states and the parameters of a single-output plant that meets the matching condition; a homogeneous injection makes it faster far from zero.':
    '估计满足匹配条件的单输出对象的状态和参数；齐次注入项使其更快。',
  'The baseline of the nonsmooth observer: the same without the homogeneous injection.':
    '非光滑观测器的基准：没有齐次注入项。',
  'Estimates only the states that are not measured, for plants with a vector relative degree that sums to n.':
    '只估计未测量的状态，适用于向量相对阶之和为 n 的对象。',
  'Estimates all states in the same normal form as the reduced-order observer: its baseline.':
    '在同一标准型中估计全部状态：降阶观测器的基准。',
  'Estimates the states before and after a hysteresis made of backlash operators; switches with their zones.':
    '估计由间隙算子构成的迟滞前后的状态；随其区域切换。',
  'The baseline of the non-smooth observer: takes the hysteresis for a constant slope.':
    '非光滑观测器的基准：把迟滞当作常数斜率。',
  'Estimates state, actuator, process and sensor faults of any continuous plant, with several outputs too.':
    '估计任意连续对象的状态以及执行器、过程和传感器故障，也适用于多输出。',
  'The adaptive Kalman observer for sampled measurements and recordings, at any sample period.':
    '用于采样测量和记录数据的自适应卡尔曼观测器，采样周期任意。',
  'Extended Kalman filter of the state augmented by the faults: the usual first choice, as a baseline.':
    '以故障扩充状态的扩展卡尔曼滤波器：通常的首选，作为基准。',
  'Unscented Kalman filter of the state augmented by the faults: no Jacobians; a baseline.':
    '以故障扩充状态的无迹卡尔曼滤波器：无需雅可比矩阵；作为基准。',

  'high gain: the error decays faster and noise grows with its powers': '高增益：误差衰减更快，噪声随其幂次增大',
  'forgetting factor of Γ: θ̂ follows faster and carries more noise': 'Γ 的遗忘因子：θ̂ 跟随更快，噪声更大',
  'initial Γ, times the unit matrix': '初始 Γ，乘单位矩阵',
  'window T of the excitation level (36)': '激励水平 (36) 的窗口 T',
  'level δ that the excitation (36) is asked to keep': '激励 (36) 应保持的水平 δ',
  'output injection; A − KC must be stable': '输出注入；A − KC 必须稳定',
  'rate of adaptation of θ̂ (with P scaled to P d = Cᵀ)': 'θ̂ 的自适应速率（P 按 P d = Cᵀ 缩放）',
  'share of the nonsmooth injection': '非光滑注入的份额',
  'exponent α of the nonsmooth injection, above 1 − 1/n and below 1': '非光滑注入的指数 α，大于 1 − 1/n 且小于 1',
  "the observer (11), or section 3's example as printed (n = 2)": '观测器 (11)，或按原文第 3 节的例子 (n = 2)',
  'output injection, block after block of unmeasured coordinates; Ã − HC̃ must be stable':
    '输出注入，按未测坐标逐块；Ã − HC̃ 必须稳定',
  'output injection, block after block of the normal form; A − LC must be stable':
    '输出注入，按标准型逐块；A − LC 必须稳定',
  "output injection on the states of L1 and L2, in the plant's order; those of L1 should be 0 (Theorem 1)":
    '对 L1 和 L2 状态的输出注入，按对象的次序；L1 的应为 0（定理 1）',
  'Δx̂(0): 0, as if x̂ had not moved before the start (hold), or by the initial estimate of the previous x (given)':
    'Δx̂(0)：0，即 x̂ 在开始前未动 (hold)，或由前一 x 的初始估计给出 (given)',
  'process noise: the variance per second by which each state equation may be off':
    '过程噪声：每个状态方程每秒允许偏差的方差',
  'measurement noise intensity of each output: its variance times the time it holds':
    '各输出的测量噪声强度：方差乘以保持时间',
  'initial P, on the diagonal; a large value makes a stiff transient': '初始 P 的对角线；过大会使过渡过程变刚性',
  'forgetting rate: θ̂ follows faster and carries more noise': '遗忘率：θ̂ 跟随更快，噪声更大',
  'initial Γ, on the diagonal; a large value makes a stiff transient': '初始 Γ 的对角线；过大会使过渡过程变刚性',
  'window T over which excitation is judged': '判断激励的窗口 T',
  'level that the excitation is asked to keep, in (typical fault / its standard deviation)²':
    '激励应保持的水平，以（典型故障 / 其标准差）² 计',
  'measurement noise of each output: its variance in one sample': '各输出的测量噪声：一次采样的方差',
  'initial P, on the diagonal: how far the first estimate may be off, squared':
    '初始 P 的对角线：初始估计可能偏差的平方',
  'initial covariance of θ̂, on the diagonal: the size of faults to be expected, squared':
    'θ̂ 初始协方差的对角线：预期故障大小的平方',
  'Runge–Kutta steps of the model in one sample interval': '一个采样间隔内模型的龙格–库塔步数',
  'how fast each θ may move: the standard deviation of a random walk after one second':
    '各 θ 变化的快慢：随机游走一秒后的标准差',
  'spread of the sigma points': 'σ 点的散布',
  'weight of the centre in covariances; 2 suits a normal distribution': '协方差中心点的权重；正态分布取 2',
  'further spread, added to N': '附加散布，加到 N 上',

  'θ = size at once.': 'θ 立即等于大小。',
  'θ rises linearly to `size` over `duration`, then stays.': 'θ 在时长内线性升到大小，然后保持。',
  'θ = rate·τ, without end.': 'θ = 速率·τ，无止境。',
  'Incipient fault: θ = size·(1 − exp(−τ/time_constant)).': '缓变故障：θ = 大小·(1 − exp(−τ/时间常数))。',
  'θ = size·sin(2π·frequency·τ + phase).': 'θ = 大小·sin(2π·频率·τ + 相位)。',
  'Intermittent fault: θ = size on [k·period, k·period + width) of τ, otherwise 0.':
    '间歇故障：在 τ 的 [k·周期, k·周期 + 宽度) 内 θ = 大小，否则为 0。',
  "θ gains a Gaussian increment of std intensity·√sample_time every sample_time; the experiment's seed drives it.":
    '每个采样时间 θ 增加一个高斯增量，标准差为 强度·√采样时间；由实验的种子决定。',
  'θ read from a table over τ; the first value holds before its time and the last after it.':
    'θ 由关于 τ 的表格给出；首值在其时刻之前保持，末值在其后保持。',
  'The sensor shows `value`.': '传感器显示给定值。',
  'The sensor goes on showing what it showed at the onset.': '传感器一直显示故障开始时的值。',
  'Each sample is lost with a probability; a lost one leaves the last value in place.':
    '每次采样以一定概率丢失；丢失时保持上一个值。',
  'Each sample is displaced by ±size with a probability.': '每次采样以一定概率偏移 ±大小。',
  'Additional Gaussian noise.': '附加高斯噪声。',
  'The output is rounded to whole multiples of the resolution.': '输出取整到分辨率的整数倍。',
  'The output arrives late.': '输出延迟到达。',

  "Size, in the channel's unit.": '大小，以通道的单位计。',
  "Final size, in the channel's unit.": '最终大小，以通道的单位计。',
  'Time in s to the final size.': '达到最终大小的时间，s。',
  "Rate, in the channel's unit per s.": '速率，每秒通道单位。',
  "Size it tends to, in the channel's unit.": '趋向的大小，以通道的单位计。',
  'Time constant in s.': '时间常数，s。',
  "Amplitude, in the channel's unit.": '幅值，以通道的单位计。',
  'Frequency in Hz.': '频率，Hz。',
  'Phase at the onset in rad.': '开始时的相位，rad。',
  "Size within the pulses, in the channel's unit.": '脉冲内的大小，以通道的单位计。',
  'Period in s.': '周期，s。',
  'Length of one pulse in s, at most the period.': '一个脉冲的长度，s，不超过周期。',
  "Standard deviation gained per √s, in the channel's unit.": '每 √s 增加的标准差，以通道的单位计。',
  'Time in s between increments.': '增量之间的时间，s。',
  'Times in s after the onset, increasing.': '开始之后的时刻，s，递增。',
  "Values at these times, in the channel's unit.": '这些时刻的值，以通道的单位计。',
  'Between two times: linear, or hold the earlier value.': '两时刻之间：线性，或保持前值。',
  "Value shown, in the output's unit.": '显示的值，以输出的单位计。',
  'Probability that a sample is lost.': '采样丢失的概率。',
  'Time in s between samples.': '采样之间的时间，s。',
  'Probability that a sample is an outlier.': '采样为野值的概率。',
  "Displacement, in the output's unit.": '偏移，以输出的单位计。',
  "Standard deviation, in the output's unit.": '标准差，以输出的单位计。',
  'Time in s for which a drawn value holds.': '抽取的值保持的时间，s。',
  "Resolution, in the output's unit.": '分辨率，以输出的单位计。',
  'Delay in s.': '延迟，s。',
};
