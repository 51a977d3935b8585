// Longer texts of the library in Chinese: descriptions of experiments, plants, parameters and signals, titles of figures, symbols of the observers.

export const prose = {
  // experiments
  'The friction of a slowly turning motor rises from 1 to 10 at 10 s. One value of the estimate says little at this noise: a band of three standard deviations that is fixed at 7 s, as tutorials have it, is left without any fault in about a third of the runs.':
    '缓慢转动的电机的摩擦在 10 s 时从 1 升到 10。在此噪声下，估计的单个数值说明不了什么：教程中在 7 s 固定的三倍标准差带，在约三分之一的无故障运行中也会被越出。',
  'A shaft of moment of inertia J, driven by a torque u against viscous friction c. Speed and acceleration are measured. The friction is what may change: it acts on the motion, and the accelerometer sees it at once.':
    '转动惯量为 J 的轴，由力矩 u 克服粘性摩擦 c 驱动。测量转速和加速度。可能改变的是摩擦：它作用于运动，加速度计立即可见。',
  'Two actuator faults and a sensor fault of a bioreactor appear one after the other and are estimated from one noisy output, together with the state.':
    '生物反应器的两个执行器故障和一个传感器故障相继出现，由一个含噪声的输出与状态一同估计。',
  "An unknown parameter is estimated by the nonsmooth observer, by the linear one, and by the linear one with the nonsmooth observer's total gain (linear-fair); the measurement is noisy.":
    '一个未知参数由非光滑观测器、线性观测器以及具有非光滑观测器总增益的线性观测器 (linear-fair) 估计；测量含噪声。',
  'Two of four states are measured; the reduced-order observer estimates the other two. Beside it the full-order observer of the same normal form. The run ends at 2 s because the plant itself escapes to infinity at t ≈ 2.515 s.':
    '四个状态中测量两个，降阶观测器估计其余两个；旁边是同一标准型的全阶观测器。运行在 2 s 结束，因为对象自身在 t ≈ 2.515 s 趋于无穷。',
  'A hysteresis between two linear parts; only the last state is measured. The non-smooth observer switches with the zones of the operators, the conventional one takes the hysteresis for a slope of 7.':
    '两个线性环节之间有迟滞；只测量最后一个状态。非光滑观测器随算子的区域切换，常规观测器把迟滞当作斜率 7。',
  'A motor is driven up and down by a voltage that jumps at random. It loses actuator gain, is loaded, gets an offset in its current sensor and at last a worn bearing. Four faults are told apart from two measurements because the voltage keeps the motor moving: at constant speed, load and friction would look the same. A fifth, the offset of the speed sensor, cannot be told from load and current offset together; leave it out, or see the excitation fail.':
    '电机由随机跳变的电压驱动。它先后失去执行器增益、加上负载、电流传感器产生偏移，最后轴承磨损。由两个测量可以区分四个故障，因为电压使电机不停变动：转速恒定时负载与摩擦看起来一样。第五个故障，转速传感器的偏移，无法与负载和电流偏移的组合区分；请不要估计它，否则会看到激励失效。',
  'Levels are measured once a second while both pumps change at random. Pump 1 loses a fifth of its flow, the sensor of tank 3 an offset, tank 1 springs a leak that widens, and the pipe between tanks 3 and 2 clogs. Each observer estimates these faults and the gain of pump 2, which stays sound: a fault must not be blamed on its neighbour.':
    '两台泵随机变化，液位每秒测量一次。泵 1 失去五分之一流量，3 号罐传感器产生偏移，1 号罐出现逐渐扩大的泄漏，3 号与 2 号罐之间的管道堵塞。每个观测器估计这些故障以及一直完好的泵 2 的增益：不得把故障归咎于邻近部件。',
  'Only the two lower levels are measured, once a second. Pump 1, which feeds tanks 1 and 4, loses a tenth of its flow; the sensor of tank 2 gets an offset; a leak in tank 1 grows slowly. The observers also estimate both upper levels and pump 2, which stays sound.':
    '只测量两个下罐的液位，每秒一次。供给 1 号和 4 号罐的泵 1 失去十分之一流量；2 号罐传感器产生偏移；1 号罐的泄漏缓慢增大。观测器还估计两个上罐的液位以及一直完好的泵 2。',
  "The bioreactor of Zhao, Li & Li in biomass and enzyme, eq. (43). Lie derivatives bring it to their canonical form, and the adaptive observer runs in the user's own coordinates; the adaptive Kalman observer needs no canonical form. The faults enter the biomass equation, which in canonical coordinates is both equations.":
    '赵、李、李的生物反应器，以生物量和酶为状态，式 (43)。Lie 导数将其化为规范型，自适应观测器在用户自己的坐标中运行；自适应卡尔曼观测器不需要规范型。故障进入生物量方程，在规范坐标中即两个方程。',
  'The observer (11) beside the lines that section 3 prints for it: without 0.1 sin(x̂1 x̂2), with the exponent 2α − 1 = .7 in both lines and ρ² for ρ k2 (w θ̂, printed twice, is taken once). It runs, but its errors do not vanish: θ̂ ends up wrong by up to 0.05 (by 0.6 if w θ̂ is taken twice).':
    '观测器 (11) 与第 3 节印刷的各行并列：没有 0.1 sin(x̂1 x̂2)，两行的指数都是 2α − 1 = .7，并以 ρ² 代替 ρ k2（印了两次的 w θ̂ 只取一次）。它能运行，但误差不消失：θ̂ 最终偏差达 0.05（若 w θ̂ 取两次则为 0.6）。',
  'As shen-hu-2015 without noise: the nonsmooth observer is ahead down to errors of about 1e-3, then the linear ones are.':
    '同 shen-hu-2015，但无噪声：误差大于约 1e-3 时非光滑观测器领先，其后线性观测器领先。',
  'The equations as printed, with nothing but a floor of 0.001 under x̂1 so that the first division is possible. The observer has a finite escape near t = 0.7 s, before any fault appears: f is not globally Lipschitz.':
    '按原文的方程，只给 x̂1 设下限 0.001 以便能做第一次除法。观测器在 t = 0.7 s 附近、任何故障出现之前就在有限时间内发散：f 不是全局 Lipschitz 的。',
  'The observer of Zhao, Li & Li at four values of ρ, without noise: the excitation of Assumption 1 falls as ρ grows.':
    '赵、李、李的观测器，取四个 ρ 值，无噪声：假设 1 的激励随 ρ 增大而下降。',
  'The same experiment without measurement noise: the estimates converge exactly, at about 1.19 per second.':
    '同一实验，无测量噪声：估计精确收敛，速率约每秒 1.19。',
  "The adaptive observer of the paper beside the adaptive Kalman observer and what one would try first, joint Kalman filters. All are set to follow a step of theta1 equally fast, within 10 % in 2.3 to 2.5 s without noise, and the adaptive ones forget equally fast; the Kalman filters are told the true noise. So the remaining difference is how much noise each estimate carries. The paper's observer needs one number, ρ; the joint filters a variance for every state and fault.":
    '论文的自适应观测器，旁边是自适应卡尔曼观测器和通常首先会尝试的联合卡尔曼滤波器。它们都调到对 θ1 的阶跃同样快（无噪声时 2.3 至 2.5 s 内进入 10 %），自适应观测器遗忘同样快，卡尔曼滤波器已知真实噪声。因此剩下的差别是各估计所带的噪声。论文的观测器只需要一个数 ρ；联合滤波器需要每个状态和故障的方差。',
  'The same experiment with noise of variance 0.001, as the paper\'s "covariance 0.001" says literally: a standard deviation of 0.0316, a third of the measured state. theta1 and theta2 drown.':
    '同一实验，噪声方差为 0.001，即按字面理解论文的“协方差 0.001”：标准差 0.0316，为被测状态的三分之一。θ1 和 θ2 被淹没。',
  'The misprint as it stands. |x12| stays below 0.002, far inside every operator: the hysteresis puts out nothing, x21 and x22 stay at 0, and none of the figures of the paper can come out.':
    '按印刷错误原样运行。|x12| 始终低于 0.002，远在每个算子之内：迟滞没有输出，x21 和 x22 保持为 0，论文的图一幅也得不到。',
  'The input is sin(2πt) instead of 5 sin(2πt), so |x12| peaks at 0.036 and the four wide operators never reach their linear zones. Here x̂12(−1) = 0, so the wrong initial estimate x̂12(0) = 0.2 moves the operators of the observer at k = 0; what that writes into their memory is never corrected, and the error of x21 is permanent.':
    '输入为 sin(2πt) 而不是 5 sin(2πt)，|x12| 峰值只有 0.036，四个宽的算子从未到达线性区。这里 x̂12(−1) = 0，错误的初始估计 x̂12(0) = 0.2 在 k = 0 推动了观测器的算子；由此写入的记忆再也不被纠正，x21 的误差是永久的。',

  // plants
  'The same bioreactor as zhao-contois, in biomass and enzyme. Lie derivatives bring it to the canonical form: z1 = biomass, z2 = the growth. Faults that enter the biomass equation here reach both canonical equations there.':
    '与 zhao-contois 相同的生物反应器，以生物量和酶为状态。Lie 导数将其化为规范型：z1 = 生物量，z2 = 增长。这里进入生物量方程的故障在规范型中进入两个方程。',
  'A permanent-magnet DC motor driven by a voltage: armature current, speed, viscous and Coulomb friction (a smooth tanh instead of a jump at standstill), a known part of the load torque. Current and speed are measured.':
    '由电压驱动的永磁直流电机：电枢电流、转速、粘性摩擦和库仑摩擦（以光滑的 tanh 代替静止处的跳变），负载转矩有已知部分。测量电流和转速。',
  "Three tanks in a row, 1–3–2, joined by pipes; pumps fill tanks 1 and 2, and tank 2 drains. Torricelli's law gives the flows. sgn(d)·√|d| has an infinite slope at equal levels: the plant uses it as it stands; an observer's model takes level differences and levels below 0.0001 cm as 0.0001 cm under the root, so that its Jacobian stays finite. The error this makes in a flow is at most 0.2 % of a usual one, and only within a micrometre of equal levels. A tank cannot run below empty: there the root is zero.":
    '三个罐按 1–3–2 由管道相连；泵向 1 号和 2 号罐供水，2 号罐有出口。流量由 Torricelli 定律给出。sgn(d)·√|d| 在液位相等处斜率无穷：对象原样使用；观测器的模型把低于 0.0001 cm 的液位差和液位在根号下取为 0.0001 cm，使其雅可比矩阵有限。由此产生的流量误差至多为通常流量的 0.2 %，且只在液位相差一微米以内。罐不会低于空罐：此时根号为零。',
  "Two pumps feed four tanks, each one lower tank and, through the valve settings gamma1 and gamma2, the upper tank on the other side; the upper tanks drain into the lower ones, whose levels are measured. With gamma1 + gamma2 above 1, as here, the plant is minimum-phase. An observer's model takes levels below 0.0001 cm as 0.0001 cm under the root, where the slope of the root would grow without bound.":
    '两台泵供给四个罐，每台供给一个下罐，并按阀门开度 gamma1 和 gamma2 供给对侧的上罐；上罐流入下罐，下罐的液位被测量。gamma1 + gamma2 大于 1 时（此处即是）对象是最小相位的。观测器的模型把低于 0.0001 cm 的液位在根号下取为 0.0001 cm，否则根号的斜率会无界增长。',
  'Vector relative degree (2, 2). With the inputs of the paper it escapes to infinity at t ≈ 2.515 s; simulate to 2 s.':
    '向量相对阶 (2, 2)。在论文的输入下于 t ≈ 2.515 s 趋于无穷；请仿真到 2 s。',
  'Two states and one unknown parameter θ that enters both equations through the known signal w. x2 integrates w θ, so x1 stays bounded only if x2(0) = −θ: the initial state goes with θ = 1.':
    '两个状态和一个未知参数 θ，θ 经已知信号 w 进入两个方程。x2 对 w θ 积分，因此只有 x2(0) = −θ 时 x1 才有界：初始状态对应 θ = 1。',
  "A bioreactor of Contois type in the coordinates x1 (biomass) and x2 = x1·w (growth), w the specific growth rate, so that x1' = x2 − u x1. Eq. (44) reads x2' = [a2 x2 (x2² − a1 u x1²) + (a1 x1 − x2)² (a4 u − a3 x2)]/(a1 a2 x1²); with w = x2/x1 that is the equation below, exactly. w lies between 0 and a1 because enzyme and biomass are positive: outside this range and near x1 = 0, f is not Lipschitz, and observers use it saturated to these ranges.":
    "Contois 型生物反应器，坐标为 x1（生物量）和 x2 = x1·w（增长），w 为比增长率，因此 x1' = x2 − u x1。式 (44) 为 x2' = [a2 x2 (x2² − a1 u x1²) + (a1 x1 − x2)² (a4 u − a3 x2)]/(a1 a2 x1²)；令 w = x2/x1 即得下面的方程。酶和生物量为正，故 w 在 0 与 a1 之间：在此范围之外以及 x1 = 0 附近 f 不是 Lipschitz 的，观测器使用限制在这些范围内的模型。",
  "The plant zhao-contois with eq. (44) letter for letter. An observer's model is kept from dividing by zero by a floor under x1 and is not extended otherwise: f is then not globally Lipschitz. Use zhao-contois to estimate; this plant shows why.":
    '逐字采用式 (44) 的 zhao-contois 对象。观测器的模型只以 x1 的下限防止除以零，此外不作延拓：于是 f 不是全局 Lipschitz 的。估计请用 zhao-contois；本对象说明其原因。',
  'A linear part L1 (x11, x12) drives seven backlash operators in parallel, a Prandtl–Ishlinskii model of hysteresis; their sum v drives a second linear part L2 (x21, x22), whose last state is measured. x12m and z1m … z7m are what the operators remember from the sample before: their input and their own outputs.':
    '线性环节 L1 (x11, x12) 驱动七个并联的间隙算子，即 Prandtl–Ishlinskii 迟滞模型；其和 v 驱动第二个线性环节 L2 (x21, x22)，其最后一个状态被测量。x12m 和 z1m … z7m 是算子对前一采样的记忆：其输入和各自的输出。',
  'x̄1 of the paper': '论文中的 x̄1',
  'x̄2 of the paper': '论文中的 x̄2',
  'largest specific growth rate': '最大比增长率',
  'saturation constant': '饱和常数',
  'enzyme used per biomass grown': '单位生物量增长消耗的酶',
  'enzyme in the feed': '进料中的酶',
  'excitation of theta1, 1 on the first half of each 0.5 s': 'θ1 的激励，每 0.5 s 的前半为 1',
  'excitation of theta2, −1 on the first half of each second': 'θ2 的激励，每秒的前半为 −1',
  'excitation of theta3, 1 on the first half of each 0.5 s': 'θ3 的激励，每 0.5 s 的前半为 1',
  'armature resistance': '电枢电阻',
  'armature inductance': '电枢电感',
  'back-EMF constant': '反电动势常数',
  'torque constant': '转矩常数',
  'moment of inertia': '转动惯量',
  'Coulomb friction': '库仑摩擦',
  'speed at which Coulomb friction is mostly there': '库仑摩擦基本达到的转速',
  'cross-section of a tank': '罐的截面积',
  'cross-section of a pipe': '管道的截面积',
  'outflow coefficient of pipe 1–3': '1–3 管的流量系数',
  'outflow coefficient of the outlet': '出口的流量系数',
  'outflow coefficient of pipe 3–2': '3–2 管的流量系数',
  gravity: '重力加速度',
  'level sensor': '液位传感器',
  'viscous friction': '粘性摩擦',
  'cross-section of tanks 1 and 3': '1、3 号罐的截面积',
  'cross-section of tanks 2 and 4': '2、4 号罐的截面积',
  'outlet of tanks 1 and 3': '1、3 号罐的出口',
  'outlet of tanks 2 and 4': '2、4 号罐的出口',
  'flow of pump 1 per volt': '泵 1 每伏的流量',
  'flow of pump 2 per volt': '泵 2 每伏的流量',
  'share of pump 1 that goes to tank 1': '泵 1 流入 1 号罐的份额',
  'share of pump 2 that goes to tank 2': '泵 2 流入 2 号罐的份额',
  'x12 one sample before': '前一采样的 x12',
  ...Object.fromEntries([1, 2, 3, 4, 5, 6, 7].map((i) => [`operator ${i} one sample before`, `前一采样的算子 ${i}`])),
  'drives L1; 5 sin(2πt) exercises the hysteresis': '驱动 L1；5 sin(2πt) 使迟滞充分动作',
  'entry of B11; the paper prints 0.004107 and 0.4107': 'B11 的元素；论文中既印 0.004107 又印 0.4107',

  // figures
  'Fig. 1: states and their estimates': '图 1：状态及其估计',
  'Fig. 2: unknown parameters and their estimates': '图 2：未知参数及其估计',
  'Fig. 3: errors of the states': '图 3：状态误差',
  'Fig. 4: errors of the parameters': '图 4：参数误差',
  'Fig. 5: persistent excitation': '图 5：持续激励',
  'Smallest eigenvalue of the Gramian (36) of Ω over the last window.':
    'Ω 的 Gram 矩阵 (36) 在最近窗口内的最小特征值。',
  'Fig. 1: error of x1': '图 1：x1 的误差',
  'Fig. 2: error of x2': '图 2：x2 的误差',
  'Fig. 3: error of θ': '图 3：θ 的误差',
  'Size of the error of θ': 'θ 误差的大小',
  'Where the lines cross, the nonsmooth observer loses its lead.': '两线相交之处，非光滑观测器不再领先。',
  'Fig. 1: estimation errors e2 and e4': '图 1：估计误差 e2 和 e4',
  'e = x̂ − x, as the paper draws it': 'e = x̂ − x，与论文的图一致',
  'Size of the estimation errors': '估计误差的大小',
  'The unmeasured states': '未测量的状态',
  'Fig. 3: input and output of the hysteresis': '图 3：迟滞的输入和输出',
  "The observer's estimates; after its first samples they are the plant's.":
    '观测器的估计；最初几个采样之后即与对象一致。',
  'Fig. 4: states and their estimates by the non-smooth observer': '图 4：状态及非光滑观测器的估计',
  'Fig. 5: states and their estimates by the conventional observer': '图 5：状态及常规观测器的估计',
  'Fig. 6: estimation errors of both observers': '图 6：两个观测器的估计误差',
  'Zone of each operator in the observer': '观测器中各算子的区域',
  '1: rising, −1: falling in its linear zone; 0: memory zone': '1：在线性区内上升，−1：下降；0：记忆区',
  'Faults and their estimates': '故障及其估计',
  'States and their estimates': '状态及其估计',
  'What the observers say of their own accuracy': '观测器对自身精度的说法',
  'One standard deviation of each estimate, from the noise alone.': '各估计的一倍标准差，只计噪声。',
  'The observer escapes': '观测器发散',
  'Excitation falls as the high gain grows': '激励随高增益增大而下降',
  'The estimates nevertheless': '尽管如此的估计',
  'Size of the estimates up to the escape; w = x2/x1 beyond its physical range makes f2 grow with its cube.':
    '发散之前估计的大小；w = x2/x1 超出物理范围时 f2 以其三次方增长。',
  'Smallest eigenvalue of the Gramian (36) over T = 1 s. Assumption 1 asks for a δ that does not depend on ρ.':
    'Gram 矩阵 (36) 在 T = 1 s 内的最小特征值。假设 1 要求 δ 与 ρ 无关。',

  Outputs: '输出',
  'Output residuals': '输出残差',
  'Estimation errors': '估计误差',
  'Inputs and known signals': '输入和已知信号',
  Excitation: '激励',
  'Dashed: the true fault; tinted: while it acts. Numbers: the values at the end. A double click shows rare peaks whole.':
    '虚线：真实故障；底色：故障存在期间。数字：结束时的值。双击可完整显示少见的尖峰。',
  'Dashed: the true state. Dotted lines mark where a fault begins or ends.':
    '虚线：真实状态。点线标出故障的开始和结束。',
  'As measured, noise and measurement faults included, and as each observer predicts it.':
    '测量值（含噪声和测量故障）以及各观测器的预测。',
  'Measured minus predicted output: what every observer corrects itself by.': '测量输出减预测输出：各观测器据此修正。',
  'Absolute errors; a straight fall is exponential. In long runs, the largest in each thousandth of the horizon.':
    '绝对误差；直线下降即指数衰减。长时间运行中取每千分之一时长内的最大值。',
  'What the plant and the observers are given.': '对象和观测器所得到的输入。',
  'Smallest eigenvalue of the excitation Gramian; below the dashed limit faults cannot be told apart.':
    '激励 Gram 矩阵的最小特征值；低于虚线时无法区分故障。',

  // observers: their titles, and what the symbols of their equations mean
  'High-gain observer': '高增益观测器',
  'Adaptive observer (Zhao, Li, Li)': '自适应观测器（赵、李、李）',
  'Nonsmooth adaptive observer (Shen, Hu)': '非光滑自适应观测器（沈、胡）',
  'Linear adaptive observer': '线性自适应观测器',
  'Reduced-order observer (MIMO, time-varying)': '降阶观测器（多输入多输出，时变）',
  'Full-order observer in the normal form': '标准型中的全阶观测器',
  'Non-smooth observer for sandwich systems (Zhou, Tan)': '三明治系统的非光滑观测器（周、谭）',
  'Conventional observer for sandwich systems': '三明治系统的常规观测器',
  'Adaptive Kalman observer': '自适应卡尔曼观测器',
  'Adaptive Kalman observer, sampled': '自适应卡尔曼观测器，采样',
  'Joint extended Kalman filter': '联合扩展卡尔曼滤波器',
  'Joint unscented Kalman filter': '联合无迹卡尔曼滤波器',
  'derivative of the canonical coordinates z = T(x); the unit matrix where the plant is in them already':
    '规范坐标 z = T(x) 的导数；对象已在其中时为单位矩阵',
  'the high gain': '高增益',
  'how θ moves the estimate of the state': 'θ 如何影响状态的估计',
  'gain of the estimate of θ; λ makes it forget': 'θ 估计的增益；λ 使其遗忘',
  'how θ moves the output: the excitation': 'θ 如何影响输出：激励',
  'diag(ρ, …, ρⁿ), the high gain ρ': 'diag(ρ, …, ρⁿ)，高增益 ρ',
  'the nonsmooth injection: strong near zero error': '非光滑注入：在零误差附近很强',
  "chain of integrators; γ is what else the plant's equations hold": '积分链；γ 是对象方程中的其余部分',
  '(CΦ)ᵀ, from the matching condition (8)': '(CΦ)ᵀ，来自匹配条件 (8)',
  'the part of the normal form that is not measured, shifted by Hy': '标准型中未测量的部分，平移 Hy',
  'coordinates of the normal form, by time-varying Lie derivatives': '标准型的坐标，由时变 Lie 导数得到',
  'output injection, one column an output': '输出注入，每个输出一列',
  '1 while rising in the linear zone; g₂ while falling, g₃ in the memory zone':
    '在线性区内上升时为 1；下降时为 g₂，记忆区为 g₃',
  'switches with the zone in which each operator is at x̂: rising, falling or memory':
    '随各算子在 x̂ 处所在的区域切换：上升、下降或记忆',
  'corrects L1 and L2; the operators follow': '修正 L1 和 L2；算子随之',
  'the hysteresis taken for a constant slope': '把迟滞当作常数斜率',
  "covariance of the state's estimate (Riccati equation)": '状态估计的协方差（Riccati 方程）',
  'twice the covariance of θ̂ where Ω changes slowly': 'Ω 变化缓慢时为 θ̂ 协方差的两倍',
  'what the measurement adds to the prediction': '测量对预测的修正',
  'derivative of the flow over one sample; Φ that with respect to θ': '一个采样内流的导数；Φ 为对 θ 的导数',
  'exp(−λ·period): what one sample forgets': 'exp(−λ·周期)：一个采样遗忘的份额',
  'taken to be a random walk': '视为随机游走',
  'the sigma points z ± √((N + κ)P) after one sample; ηᵢ what they would measure':
    '一个采样之后的 σ 点 z ± √((N + κ)P)；ηᵢ 为其对应的测量',
  'their weights, from α, β and κ': '其权重，由 α、β、κ 得出',
};
