function [alpha_filt, sync] = filtered(alpha)
% alpha_filt, the mean of four backward differences, and the samples of the other signals that it belongs to.
width = 4;  % the mean is 1.5 samples late, and the backward difference half a sample
alpha_filt = conv(alpha(2:end), ones(width, 1) / width, 'valid');
sync = (1 : numel(alpha_filt))' + width / 2;
end
