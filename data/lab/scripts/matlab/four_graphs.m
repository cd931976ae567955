function four_graphs(t, omega, alpha, t_sync, alpha_filt, M, style)
% Speed, acceleration, filtered acceleration and torque one above the other, added to what the figure holds.
labels = {'\omega / (rad/s)', '\alpha / (rad/s^2)', '\alpha_{filt} / (rad/s^2)', 'M / (N*m)'};
times = {t, t, t_sync, t};
signals = {omega, alpha, alpha_filt, M};
for k = 1 : 4
    subplot(4, 1, k);
    hold on
    plot(times{k}, signals{k}, style);
    ylabel(labels{k});
    grid on
end
xlabel('time / s');
end
